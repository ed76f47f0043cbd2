// Numbers that a case file gives as texts: formulas of the constants, and numbers with a unit.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "geometry/base.h"
#include "geometry/text.h"
#include "io/case_files/case_document.h"
#include "io/case_files/formula.h"
#include "io/case_files/key.h"
#include "io/case_files/unit.h"

namespace flexmorph::io {
namespace {

using Kind = CaseNode::Kind;

constexpr const char* kConstants = "constants";

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_word_character(char c) { return is_letter(c) || (c >= '0' && c <= '9'); }

bool is_word(const std::string& text) {
  return !text.empty() && is_letter(text[0]) &&
         std::all_of(text.begin(), text.end(), is_word_character);
}

/// Returns the names in a formula.
std::set<std::string> names_in(const std::string& text) {
  std::set<std::string> out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (!is_word_character(text[i])) continue;
    const size_t start = i;
    while (i < text.size() && is_word_character(text[i])) ++i;
    if (is_letter(text[start])) out.insert(text.substr(start, i - start));
  }
  return out;
}

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// A number, and the text of the unit that follows it.
struct NumberWithUnit {
  double number = 0;
  std::string unit;
};

/// Returns the parts of a text such as "12 mm"; nothing for a formula.
std::optional<NumberWithUnit> number_with_unit(const std::string& text) {
  NumberWithUnit out;
  const char *const start = text.data() + (text.starts_with('+') ? 1 : 0), *const end =
                                                                               text.data() +
                                                                               text.size();
  const auto [at, error] = std::from_chars(start, end, out.number);
  if (error != std::errc() || !std::isfinite(out.number)) return {};
  const bool blank = at < end && *at == ' ';
  out.unit = trimmed(std::string(at, end));
  if (out.unit.empty()) return {};
  const char first = out.unit[0];
  const bool begins =
      is_letter(first) || static_cast<unsigned char>(first) > 127 || (blank && first == '1');
  return begins ? std::optional(out) : std::nullopt;
}

/// Gives a node the value of its text.
void set_number(CaseNode& node, double value) {
  constexpr double kLargestWhole = 1LL << 53;
  const bool whole =
      node.unit.empty() && value == std::round(value) && std::abs(value) < kLargestWhole;
  node.kind = whole ? Kind::integer : Kind::number;
  node.number = value;
  node.integer = whole ? static_cast<int64_t>(value) : 0;
}

/// Computes the value of a text in SI units, or stores in the node why it is not a number.
void read_number_text(CaseNode& node, const std::map<std::string, double>& constants) {
  const std::string text = trimmed(node.text);
  if (const auto found = number_with_unit(text)) {
    const std::optional<Unit> unit = read_unit(found->unit);
    if (!unit) {
      node.problem = "'" + found->unit + "' is not a known unit";
      return;
    }
    node.unit = found->unit;
    set_number(node, unit->si(found->number));
    return;
  }
  try {
    set_number(node, constant_value(text, constants));
  } catch (const Error& error) {
    const std::string start = "formula '" + text + "': ";
    node.problem = error.what();
    if (node.problem.starts_with(start)) node.problem = node.problem.substr(start.size());
  }
}

/// Computes the constants of a case, each after those that its formula names.
class Constants {
 public:
  explicit Constants(CaseNode* table) : table_(table) {
    if (table_ == nullptr || table_->kind != Kind::table) return;
    for (CaseNode& node : table_->entries) compute(node);
  }
  const std::map<std::string, double>& values() const { return values_; }

 private:
  void compute(CaseNode& node) {
    if (!seen_.insert(&node).second) return;
    if (node.kind == Kind::text) {
      open_.push_back(node.key);
      for (const std::string& name : names_in(node.text))
        if (CaseNode* other = table_->find(name)) {
          const auto cycle = std::find(open_.begin(), open_.end(), name);
          if (cycle == open_.end()) {
            compute(*other);
            continue;
          }
          const std::vector<std::string> names(cycle, open_.end());
          node.problem = names.size() == 1 ? "the constant '" + name + "' depends on itself"
                                           : "the constants " + joined(names, ", ", "'") +
                                                 " depend on each other";
        }
      open_.pop_back();
      if (node.problem.empty()) read_number_text(node, values_);
      node.unit.clear();  // the value is in SI units, and a constant may have any unit
    }
    const bool number = node.kind == Kind::number || node.kind == Kind::integer;
    if (number && std::isfinite(node.number) && Formula::refusal_of_name(node.key).empty())
      values_[node.key] = node.number;
  }

  CaseNode* table_;
  std::map<std::string, double> values_;
  std::set<const CaseNode*> seen_;
  std::vector<std::string> open_;  // constants whose formulas are being computed
};

/// What the declarations of one key allow beside numbers.
struct Allowed {
  bool number = false;  ///< True if the key takes numbers.
  bool text = false;    ///< True if the key takes any text.
  bool name = false;    ///< True if the key takes names that the case gives.
  std::set<std::string> words;
};

Allowed allowed_by(const std::vector<const Key*>& declared) {
  Allowed out;
  for (const Key* key : declared)
    for (const Form& form : key->forms) {
      out.number |= form.kind == Form::Kind::number || form.kind == Form::Kind::integer;
      out.text |= form.kind == Form::Kind::text;
      out.name |= !form.or_name.empty() || (form.kind == Form::Kind::word && !form.allowed);
      if (form.kind == Form::Kind::word)
        for (const std::string& word : form.words()) out.words.insert(word);
    }
  return out;
}

/// Collects the names that the entries of all lists of tables have.
void collect_names(const CaseNode& node, std::set<std::string>& out) {
  for (const CaseNode& child : node.entries) {
    if (child.key == "name" && child.kind == Kind::text) out.insert(child.text);
    collect_names(child, out);
  }
}

class NumberTexts {
 public:
  explicit NumberTexts(CaseNode& root) : constants_(root.find(kConstants)) {
    collect_names(root, names_);
    table(root, "");
  }

 private:
  void table(CaseNode& node, const std::string& kind) {
    const auto keys = book_.find(kind);
    if (keys == book_.end() || kind == kConstants) return;
    for (CaseNode& child : node.entries) {
      auto declared = keys->second.find(child.key);
      const bool free = declared == keys->second.end();
      if (free) declared = keys->second.find("*");
      if (declared == keys->second.end()) continue;
      const std::string below = (kind.empty() ? "" : kind + ".") + (free ? "*" : child.key);
      if (child.kind == Kind::table) table(child, below);
      for (CaseNode& entry : child.entries)
        if (child.kind == Kind::list && entry.kind == Kind::table) table(entry, below);
      if (const Allowed allowed = allowed_by(declared->second); allowed.number)
        value(child, allowed);
    }
  }

  void value(CaseNode& node, const Allowed& allowed) {
    if (node.kind == Kind::list)
      for (CaseNode& entry : node.entries) value(entry, allowed);
    if (node.kind != Kind::text || allowed.text || allowed.words.contains(node.text)) return;
    const bool may_be_name = (allowed.name || !allowed.words.empty()) && is_word(node.text);
    if (may_be_name && (names_.contains(node.text) || !constants_.values().contains(node.text)))
      return;
    read_number_text(node, constants_.values());
  }

  using Keys = std::map<std::string, std::vector<const Key*>>;
  static std::map<std::string, Keys> keys_by_table() {
    std::map<std::string, Keys> out;
    for (const Key& key : all_keys())
      for (const std::string& each : key.tables) out[each][key.name].push_back(&key);
    return out;
  }

  const std::map<std::string, Keys> book_ = keys_by_table();
  const Constants constants_;
  std::set<std::string> names_;
};

}  // namespace

void CaseDocument::read_number_texts() { NumberTexts reader(root); }

}  // namespace flexmorph::io
