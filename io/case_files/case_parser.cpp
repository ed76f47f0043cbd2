#include "io/case_files/case_parser.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "geometry/base.h"
#include "io/case_files/case_limits.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

/// Returns ":14:13", line and column (characters, not bytes) as editors count them.
std::string location_in(const toml::source_position& at) {
  return std::string(":")
      .append(std::to_string(at.line))
      .append(":")
      .append(std::to_string(at.column));
}

std::vector<bool> plain_lines(const std::vector<std::string>& lines) {
  std::vector<bool> out;
  for (const std::string& line : lines)
    out.push_back(std::all_of(line.begin(), line.end(),
                              [](char c) { return static_cast<unsigned char>(c) < 128; }));
  return out;
}

/// The source text of a tree: its lines, and its name in messages.
struct Source {
  std::vector<std::string> lines;
  std::string name;
  bool is_option;
  // true for lines of ASCII only; computed once, because lines may be long
  std::vector<bool> plain = plain_lines(lines);

  std::string location(const toml::source_region& region) const {
    if (is_option || !region.begin) return name;
    return name + location_in(region.begin);
  }

  /// Returns a value as it is written in the source; empty if it fills several lines.
  std::string written(const toml::source_region& region) const {
    if (!region.begin || region.begin.line != region.end.line || region.begin.line > lines.size())
      return "";
    const std::string& line = lines[region.begin.line - 1];
    // Columns count characters, not bytes, therefore only ASCII lines can be cut by columns.
    if (!plain[region.begin.line - 1] || region.end.column <= region.begin.column) return "";
    std::string value =
        line.substr(region.begin.column - 1, region.end.column - region.begin.column);
    value.erase(value.find_last_not_of(" \t\r") + 1);
    return value;
  }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    if (c == '\n') {
      lines.emplace_back();
    } else {
      lines.back() += c;
    }
  }
  return lines;
}

CaseNode convert(const toml::node& node, const Source& source);

void convert_entries(const toml::table& table, const Source& source, CaseNode& result) {
  std::vector<std::tuple<toml::source_position, std::string, const toml::node*>> ordered;
  for (const auto& [key, child] : table)
    ordered.emplace_back(child.source().begin, std::string(key.str()), &child);
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return std::get<0>(a) < std::get<0>(b); });
  for (const auto& [position, key, child] : ordered)
    result.entries.emplace_back(convert(*child, source)).key = key;
}

/// Sets the value and its default text for every node except a table.
void convert_value(const toml::node& node, const Source& source, CaseNode& result) {
  using Kind = CaseNode::Kind;
  if (const toml::array* list = node.as_array()) {
    result.kind = Kind::list;
    std::string inside;
    for (const toml::node& child : *list) {
      result.entries.push_back(convert(child, source));
      inside += (inside.empty() ? "" : ", ") + result.entries.back().shown;
    }
    result.shown = "[" + inside + "]";
  } else if (const auto* text = node.as_string()) {
    result.kind = Kind::text;
    result.text = text->get();
    result.shown = in_quotes(result.text);
  } else if (const auto* whole = node.as_integer()) {
    result.kind = Kind::integer;
    result.integer = whole->get();
    result.number = static_cast<double>(whole->get());
    result.shown = std::to_string(whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    result.kind = Kind::number;
    result.number = number->get();
    result.shown = to_text(result.number);
  } else if (const auto* boolean = node.as_boolean()) {
    result.kind = Kind::boolean;
    result.integer = boolean->get();
    result.shown = boolean->get() ? "true" : "false";
  } else {
    result.kind = Kind::other;  // dates and times, which no key accepts
    result.shown = "a date or time";
  }
}

CaseNode convert(const toml::node& node, const Source& source) {
  CaseNode result;
  result.location = source.location(node.source());
  result.line = node.source().begin.line;
  if (const toml::table* table = node.as_table()) {
    result.is_inline = table->is_inline();
    result.shown = "{...}";
    convert_entries(*table, source, result);
    return result;
  }
  convert_value(node, source, result);
  const std::string written = source.written(node.source());
  if (!written.empty()) result.shown = written;
  return result;
}

}  // namespace

std::string read_text(const std::string& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (!std::filesystem::exists(status)) throw Error::input(path + ": no such file");
  if (std::filesystem::is_directory(status))
    throw Error::input(path + ": this is a directory; a case is one TOML file");
  std::ifstream in(path, std::ios::binary);
  // A case may come from a pipe. The limit is needed because input from a device may never end.
  constexpr size_t kMaxBytes = 100'000'000;
  std::string text, block(size_t{1} << 16U, '\0');
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    text.append(block, 0, static_cast<size_t>(in.gcount()));
    if (text.size() > kMaxBytes)
      throw Error::input(
          path + ": this file is larger than 100 MB; a case is one TOML file of at most 100 MB");
  }
  if (!in.is_open() || in.bad()) throw Error::input(path + ": cannot be read");
  return text;
}

namespace {

/// Returns a hint about the most frequent causes of an error: habits from other languages and
/// formats.
std::string hint_of(const std::string& reason, const std::string& line, size_t column) {
  constexpr std::string_view kSaw = "saw '";
  const size_t mark = reason.find(kSaw);
  const char saw = mark == std::string::npos ? '\0' : reason[mark + kSaw.size()];
  const auto at = [&](size_t location) {
    return location < line.size() ? static_cast<unsigned char>(line[location]) : '\0';
  };
  const bool behind_number = column >= 2 && (std::isdigit(at(column - 2)) || at(column - 2) == ' ');
  if (reason.find("utf-8") != std::string::npos) return "a case is UTF-8 text";
  if (reason.find("value type") != std::string::npos) return "a text is written in quotes";
  if (reason.find("parsing string") != std::string::npos) return "a closing quote is missing";
  if (saw == ':') return "a key and its value are separated by '='";
  if (saw == ',') return "a number has a decimal point, not a comma";
  if (saw == ';') return "a line must not end with a semicolon";
  if (behind_number && std::isalpha(at(column - 1)) &&
      reason.find("comment or whitespace") != std::string::npos)
    return "a number with a unit is a text in quotes, such as \"0.5 m\"";
  return "";
}

/// Returns the reason of an error, the line in which it is, and a hint.
std::string syntax_text(const toml::parse_error& e, const std::string& text) {
  constexpr size_t kMaxQuotedLength = 60;
  const std::string reason(e.description());
  const std::vector<std::string> lines = lines_of(text);
  const size_t number = e.source().begin.line;
  std::string line;
  if (number >= 1 && number <= lines.size()) line = lines[number - 1];
  if (line.ends_with('\r')) line.pop_back();
  const std::string hint = hint_of(reason, line, e.source().begin.column);
  // Lines that contain other than printable characters are not shown.
  const bool plain = std::all_of(line.begin(), line.end(),
                                 [](char c) { return c == '\t' || (c >= 32 && c < 127); });
  std::string out = reason;
  if (const size_t first = line.find_first_not_of(" \t"); plain && first < line.size())
    out.append(" in `").append(line, first, kMaxQuotedLength).append("`");
  if (!hint.empty()) out.append(": ").append(hint);
  return out;
}

}  // namespace

CaseNode parse_case(const std::string& text, const std::string& file) {
  check_case_limits(text, file);
  try {
    const toml::table root = toml::parse(text, file);
    CaseNode node = convert(root, {lines_of(text), file, false});
    node.location = file + ":1:1";  // location that messages name for missing keys
    return node;
  } catch (const toml::parse_error& e) {
    throw Error::input(file + location_in(e.source().begin) +
                       ": not TOML: " + syntax_text(e, text));
  }
}

namespace {

/// Returns true for a number with a unit and for a formula.
bool is_unquoted_number(const std::string& value) {
  const auto is_of = [](unsigned char c) {
    return std::isalnum(c) || c > 127 ||
           std::string_view(" _.+-*/^()").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (!std::all_of(value.begin(), value.end(), is_of)) return false;
  const bool has_letter = std::any_of(value.begin(), value.end(),
                                      [](unsigned char c) { return std::isalpha(c) || c > 127; });
  const bool has_operator = value.find_first_of("+-*/^(") != std::string::npos;
  const bool starts_as_number =
      !value.empty() && std::string_view("0123456789.+-").find(value[0]) != std::string_view::npos;
  return has_operator || (has_letter && starts_as_number);
}

}  // namespace

CaseNode parse_option(const std::string& value, const std::string& option) {
  // A word, such as plate.tip_deflection, may be given without quotes, because shells remove them.
  std::string joined = value;
  std::erase(joined, '.');
  const bool word = is_bare_key(joined) && std::isalpha(static_cast<unsigned char>(value[0])) &&
                    value != "true" && value != "false" && value != "inf" && value != "nan";
  std::string text = "value = ";
  text += word ? in_quotes(value) : value;
  check_case_limits(text, option);
  try {
    const toml::table root = toml::parse(text, option);
    if (root.size() != 1) throw Error::input(option + ": VALUE must be one TOML value");
    CaseNode node = convert(*root.get("value"), {{text}, option, true});
    node.is_option = true;
    return node;
  } catch (const toml::parse_error& e) {
    // The shell removes the quotes of "12 mm" and "2*h".
    if (is_unquoted_number(value)) return parse_option(in_quotes(value), option);
    throw Error::input(option + ": VALUE is not TOML: " + std::string(e.description()));
  }
}

std::string in_quotes(const std::string& text) {
  constexpr const char* kHex = "0123456789ABCDEF";
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += std::string("\\") + c;
    } else if (c == '\n') {
      result += "\\n";
    } else if (code < 32 || code == 127) {
      result += std::string("\\u00") + kHex[code / 16] + kHex[code % 16];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

}  // namespace flexmorph::io
