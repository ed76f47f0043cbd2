#include "geometry/archive.h"

#include <boost/crc.hpp>
#include <cstring>

namespace flexmorph {
namespace {

[[noreturn]] void refuse() {
  throw Error::input("checkpoint: the data end too early, or they belong to another object");
}

}  // namespace

void Archive::raw(void* data, size_t bytes) {
  if (bytes == 0) return;
  if (!puts_back_) {
    bytes_.append(static_cast<const char*>(data), bytes);
    return;
  }
  if (bytes > bytes_.size() - at_) refuse();
  std::memcpy(data, bytes_.data() + at_, bytes);
  at_ += bytes;
}

size_t Archive::size(size_t now, size_t least) {
  std::uint64_t out = now;
  raw(&out, sizeof out);
  // A damaged archive must not cause a huge allocation.
  const size_t left = bytes_.size() - at_;
  if (puts_back_ && (out > bytes_.size() || (least > 0 && out > left / least))) refuse();
  return static_cast<size_t>(out);
}

void Archive::one(Eigen::SparseMatrix<double>& a) {
  using Index = Eigen::Index;
  if (!puts_back_) a.makeCompressed();
  const size_t m = size(static_cast<size_t>(a.rows()), 0),
               n = size(static_cast<size_t>(a.cols()), sizeof(int)),
               filled = size(static_cast<size_t>(a.nonZeros()), sizeof(double));
  if (puts_back_) {
    a.resize(static_cast<Index>(m), static_cast<Index>(n));
    a.resizeNonZeros(static_cast<Index>(filled));
  }
  raw(a.outerIndexPtr(), (n + 1) * sizeof(int));
  raw(a.innerIndexPtr(), filled * sizeof(int));
  raw(a.valuePtr(), filled * sizeof(double));
}

std::uint64_t checksum(std::string_view bytes) {
  boost::crc_optimal<64, 0x42F0E1EBA9EA3693ULL, 0, 0, false, false> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

}  // namespace flexmorph
