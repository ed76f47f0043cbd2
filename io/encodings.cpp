#include "io/encodings.h"

#include <vtkBase64Utilities.h>
#include <vtkNew.h>
#include <vtkZLibDataCompressor.h>

#include "geometry/base.h"

namespace flexmorph::io {

std::string base64(std::string_view bytes) {
  std::string out(2 * bytes.size() + 4, '\0');
  const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
  out.resize(
      vtkBase64Utilities::Encode(from, bytes.size(), reinterpret_cast<unsigned char*>(out.data())));
  return out;
}

std::string compressed(std::string_view bytes) {
  vtkNew<vtkZLibDataCompressor> compressor;
  compressor->SetCompressionLevel(5);
  std::string out(compressor->GetMaximumCompressionSpace(bytes.size()), '\0');
  const size_t size =
      compressor->Compress(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
                           reinterpret_cast<unsigned char*>(out.data()), out.size());
  if (size == 0) throw Error::numerical("VTK cannot compress the data of a page");
  out.resize(size);
  return out;
}

}  // namespace flexmorph::io
