#pragma once

#include <string>

namespace flexmorph::io {

/// A value of a case that differs from its default.
struct Setting {
  std::string path, value, fallback;  ///< Path of the key; its value and its default as TOML text.
  std::string sentence;               ///< Sentence that explains the key.
  bool is_option = false;             ///< True if a --set option gave the value.
};

}  // namespace flexmorph::io
