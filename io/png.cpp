#include "io/png.h"

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

#include "geometry/base.h"

namespace flexmorph::io {

std::string png(const Pixels& pixels) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(pixels.width, pixels.height, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, pixels.channels);
  auto* to = static_cast<unsigned char*>(image->GetScalarPointer());
  const auto row = static_cast<size_t>(pixels.width) * static_cast<size_t>(pixels.channels);
  for (int y = pixels.height - 1; y >= 0; --y)  // the first row of VTK is the lowest one
    to = std::copy_n(pixels.values.data() + static_cast<size_t>(y) * row, row, to);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  if (!bytes) throw Error::numerical("VTK cannot encode a picture");
  return {reinterpret_cast<const char*>(bytes->GetPointer(0)),
          static_cast<size_t>(bytes->GetNumberOfValues())};
}

std::array<unsigned char, 3> map_color(double share) {
  constexpr std::array<std::array<double, 3>, 5> kStops = {
      {{68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}}};
  const double at = share * (kStops.size() - 1);
  const size_t i = std::min(static_cast<size_t>(at), kStops.size() - 2);
  std::array<unsigned char, 3> color{};
  for (size_t k = 0; k < 3; ++k)
    color[k] = static_cast<unsigned char>(std::lround(
        kStops[i][k] + (at - static_cast<double>(i)) * (kStops[i + 1][k] - kStops[i][k])));
  return color;
}

}  // namespace flexmorph::io
