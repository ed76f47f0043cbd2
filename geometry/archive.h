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

/// An archive (checkpoint) that saves or restores the variables with which a computation continues
/// bit for bit. A class lists its variables once, and one function both saves and restores them:
///
///   void archive(Archive& m, Path& p) { m(p.start, p.points); }
///
/// Numbers, enumerations and plain structs are saved as their bytes, in the byte order of the
/// machine; strings, vectors, optional values and matrices as their size and contents; all other
/// types by their member function archive(Archive&), or by a function archive(Archive&, T&) in
/// their namespace.
class Archive {
 public:
  /// Creates an empty archive that saves.
  Archive() = default;
  /// Creates an archive that restores what bytes() of another one contains.
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)), puts_back_(true) {}

  /// Returns true if the archive restores, false if it saves.
  bool is_restoring() const { return puts_back_; }
  /// Returns the bytes of the archive.
  const std::string& bytes() const { return bytes_; }

  /// Saves or restores variables, in the order of the arguments.
  /// @throws Error (input) when the archive holds less data than is to be restored.
  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

  /// Saves or restores whether a version number `version`, on which the computation depends, is
  /// equal to the current one, `now`. After restoring, `version` is `now` if it was up to date,
  /// else -1.
  /// @returns true if the version was up to date
  bool up_to_date(int& version, int now) {
    bool is = version == now;
    one(is);
    if (puts_back_) version = is ? now : -1;
    return is;
  }

 private:
  template <class T>
  static constexpr bool kPlain = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>;

  /// Saves or restores bytes.
  void raw(void* data, size_t bytes);
  /// Saves or restores a size. When it restores, it throws if the archive does not hold at least
  /// `least` bytes for each item.
  size_t size(size_t now, size_t least);

  template <class T>
  void one(T& x) {
    if constexpr (requires { x.archive(*this); })
      x.archive(*this);
    else if constexpr (kPlain<T>)
      raw(&x, sizeof x);
    else
      archive(*this, x);  // found by its argument type
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
  /// Saves or restores a sparse matrix in compressed form.
  void one(Eigen::SparseMatrix<double>& a);

  std::string bytes_;
  bool puts_back_ = false;
  size_t at_ = 0;  // position of the next byte to be restored
};

/// Returns the CRC-64 (ECMA-182) of bytes. It detects damaged files and changed inputs, but no
/// forgery.
std::uint64_t checksum(std::string_view bytes);

}  // namespace flexmorph
