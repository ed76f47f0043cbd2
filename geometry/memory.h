#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "geometry/base.h"

namespace flexmorph {

/// Takes down what a computation needs to go on bit for bit, or puts it back. A class names its
/// variables once, and the same function serves both ways:
///
///   void remember(Memory& m, Path& p) { m(p.start, p.points); }
///
/// Numbers, enumerations and plain structs of them are kept as their bytes, in the byte order of
/// the machine; texts, vectors, optional values and matrices as their size and contents; all else
/// by its member remember(Memory&), or a function remember(Memory&, T&) beside it.
class Memory {
 public:
  Memory() = default;                 ///< takes down
  explicit Memory(std::string bytes)  ///< puts back
      : bytes_(std::move(bytes)), puts_back_(true) {}

  bool puts_back() const { return puts_back_; }
  const std::string& bytes() const { return bytes_; }

  /// @throws Error (input) when less was taken down than is to be put back.
  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

  /// A version number of something the computation depends on: kept is whether it was up to date.
  /// @returns whether it was
  bool up_to_date(int& version, int now) {
    bool is = version == now;
    one(is);
    if (puts_back_) version = is ? now : -1;
    return is;
  }

 private:
  template <class T>
  static constexpr bool kPlain = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>;

  /// Takes down bytes, or puts them back.
  void raw(void* data, size_t bytes);
  /// The same for a size; of what follows `least` bytes an item are there.
  size_t size(size_t now, size_t least);

  template <class T>
  void one(T& x) {
    if constexpr (requires { x.remember(*this); })
      x.remember(*this);
    else if constexpr (kPlain<T>)
      raw(&x, sizeof x);
    else
      remember(*this, x);  // found beside T
  }
  void one(std::string& text) {
    text.resize(size(text.size(), 1));
    raw(text.data(), text.size());
  }
  template <class T>
  void one(std::vector<T>& all) {
    all.resize(size(all.size(), kPlain<T> ? sizeof(T) : 0));
    if constexpr (kPlain<T>)
      raw(all.data(), all.size() * sizeof(T));
    else
      for (T& each : all) one(each);
  }
  template <class T, size_t n>
  requires(!kPlain<T>) void one(std::array<T, n>& all) {
    for (T& each : all) one(each);
  }
  template <class T>
  void one(std::optional<T>& x) {
    bool is = x.has_value();
    one(is);
    if (puts_back_ && is) x.emplace();
    if (puts_back_ && !is) x.reset();
    if (is) one(*x);
  }
  template <class T, int rows, int columns, int options, int most_rows, int most_columns>
  void one(Eigen::Matrix<T, rows, columns, options, most_rows, most_columns>& x) {
    const size_t m = size(static_cast<size_t>(x.rows()), 0),
                 n = size(static_cast<size_t>(x.cols()), m * sizeof(T));
    x.resize(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(n));
    raw(x.data(), m * n * sizeof(T));
  }
  /// Compressed.
  void one(Eigen::SparseMatrix<double>& a);

  std::string bytes_;
  bool puts_back_ = false;
  size_t at_ = 0;  // what was put back
};

/// CRC-64 (ECMA-182) of bytes: tells damaged files and changed inputs, not forged ones.
std::uint64_t checksum(std::string_view bytes);

}  // namespace flexmorph
