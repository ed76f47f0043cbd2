#include "io/case_files/case_forms.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "io/case_files/other_terms.h"
#include "io/case_files/unit.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

using Kind = CaseNode::Kind;

bool is_number(const CaseNode& node) {
  return node.kind == Kind::number || node.kind == Kind::integer;
}

/// Returns true if a number has no unit, or one that measures the quantity.
bool unit_fits(const CaseNode& node, const Quantity& quantity) {
  if (node.unit.empty()) return true;
  const std::optional<Unit> wanted = read_unit(quantity.unit), given = read_unit(node.unit);
  return wanted && given && wanted->dimension == given->dimension;
}

/// Returns true if a single value (an entry of a list, or no list) has a form.
bool fits_one(const CaseNode& node, const Form& form) {
  switch (form.kind) {
    case Form::Kind::number:
      return read_number(node, form.quantity).has_value() ||
             (!form.or_name.empty() && node.kind == Kind::text);
    case Form::Kind::integer:
      return read_integer(node, form).has_value();
    case Form::Kind::boolean:
      return node.kind == Kind::boolean;
    case Form::Kind::text:
      return node.kind == Kind::text;
    case Form::Kind::table:
      return node.kind == Kind::table;
    case Form::Kind::tables:
      return node.kind == Kind::list &&
             std::all_of(node.entries.begin(), node.entries.end(),
                         [](const CaseNode& entry) { return entry.kind == Kind::table; });
    case Form::Kind::word:
      break;
  }
  if (node.kind != Kind::text) return false;
  const Words words = form.words();  // none if the case gives the allowed names
  return !form.allowed || std::find(words.begin(), words.end(), node.text) != words.end();
}

bool fits(const CaseNode& node, const Form& form) {
  if (!form.is_list) return fits_one(node, form);
  const auto size = static_cast<int>(node.entries.size());
  if (node.kind != Kind::list || size < form.least || (form.most > 0 && size > form.most))
    return false;
  std::set<std::string> seen;
  return std::all_of(node.entries.begin(), node.entries.end(), [&](const CaseNode& entry) {
    if (form.columns > 0)
      return entry.kind == Kind::list &&
             entry.entries.size() == static_cast<size_t>(form.columns) &&
             std::all_of(entry.entries.begin(), entry.entries.end(),
                         [&](const CaseNode& each) { return fits_one(each, form); });
    return fits_one(entry, form) &&
           (form.kind != Form::Kind::word || seen.insert(entry.text).second);
  });
}

/// Returns true if the node has the type of the form, even if the value is not allowed.
bool is_alike(const CaseNode& node, const Form& form) {
  if (node.kind == Kind::list) {
    if (form.kind == Form::Kind::tables) return true;
    const bool texts = !node.entries.empty() && node.entries.front().kind == Kind::text;
    if (form.is_list && !form.or_name.empty()) return true;
    return form.is_list &&
           texts == (form.kind == Form::Kind::text || form.kind == Form::Kind::word);
  }
  if (form.is_list) return false;
  switch (form.kind) {
    case Form::Kind::number:
    case Form::Kind::integer:
      return is_number(node);
    case Form::Kind::boolean:
      return node.kind == Kind::boolean;
    case Form::Kind::text:
    case Form::Kind::word:
      return node.kind == Kind::text;
    case Form::Kind::table:
    case Form::Kind::tables:
      return node.kind == Kind::table;
  }
  return false;
}

std::string allowed_one(const CaseNode& node, const Form& form, const std::string& full) {
  const std::string& noun = form.quantity.noun;
  switch (form.kind) {
    case Form::Kind::number:
      if (!form.or_name.empty()) return number_or_name(form);
      return form.quantity.allowed();
    case Form::Kind::integer:
      return whole_number(form);
    case Form::Kind::boolean:
      return "true or false";
    case Form::Kind::text:
      return form.is_list ? noun : noun + " is a text in quotes";
    case Form::Kind::table:
      return "[" + full + "] is a table";
    case Form::Kind::tables:
      return "a list of tables, each with the heading [[" + full + "]]";
    case Form::Kind::word:
      break;
  }
  const Words words = form.words();
  if (words.empty()) return noun + " is a name in quotes";
  return form.is_list ? one_of(noun, words) + ", each name at most once"
                      : one_of(noun, words, node.text);
}

std::string allowed(const CaseNode& node, const Form& form, const std::string& full) {
  std::string each = allowed_one(node, form, full);
  if (form.kind == Form::Kind::number || form.kind == Form::Kind::integer)
    each += refusal_of_number(node, form.quantity);
  if (!form.is_list) return each;
  if (form.columns > 0) each = "lists of " + to_text(form.columns) + " numbers; " + each;
  return list_of(form) + each;
}

using Declared = std::vector<const Key*>;
using KeysOfTable = std::map<std::string, Declared>;

/// Returns the keys by kind of table ("body.flow") and name. A key may be declared several times,
/// for different cases.
std::map<std::string, KeysOfTable> keys_by_table() {
  std::map<std::string, KeysOfTable> out;
  for (const Key& key : all_keys())
    for (const std::string& table : key.tables) out[table][key.name].push_back(&key);
  return out;
}

class BookReader {
 public:
  BookCheck out;

  void table(const CaseNode& node, const std::string& kind, const std::string& path) {
    const auto found = book_.find(kind);
    if (found == book_.end()) return;
    const KeysOfTable& keys = found->second;
    std::vector<std::string> known, strange;
    for (const auto& [name, declared] : keys)
      if (name != "*") known.push_back(name);
    const auto any = keys.find("*");
    for (const CaseNode& child : node.entries) {
      const std::string full = path.empty() ? child.key : path + "." + child.key;
      const auto declared = keys.find(child.key);
      if (declared != keys.end()) {
        value(child, declared->second, below(kind, child.key), full);
      } else if (any != keys.end()) {
        value(child, any->second, below(kind, "*"), full);
      } else {
        strange.push_back(child.key);
        const std::string close = nearest(child.key, known), answer = answer_to_key(child.key);
        out.unknown.push_back(
            {child.line, located(child, full),
             ": unknown key" + (!answer.empty() ? "; " + answer
                                : close.empty()
                                    ? "; the command flexmorph keys " +
                                          (kind.empty() ? "top" : kind) + " lists the allowed keys"
                                    : ", did you mean '" + close + "'?")});
      }
    }
    for (const auto& [name, declared] : keys) missing(node, name, declared, strange, path);
  }

 private:
  static std::string below(const std::string& kind, const std::string& key) {
    return kind.empty() ? key : kind + "." + key;
  }

  void value(const CaseNode& node, const Declared& declared, const std::string& kind,
             const std::string& full) {
    std::string words;  // allowed values for the message
    bool alike = false;
    for (const Key* key : declared)
      for (const Form& form : key->forms) {
        if (fits(node, form)) return inside(node, form, kind, full);
        // A key may have several declarations for different cases. The message uses one for the
        // same type of value if there is any, and of several ones the shortest, because the
        // declarations have no order.
        const std::string own = allowed(node, form, full);
        const bool like = is_alike(node, form);
        if (words.empty() || (like && !alike) ||
            (like == alike &&
             std::make_pair(own.size(), own) < std::make_pair(words.size(), words))) {
          words = own;
          alike = like;
        }
      }
    if (!words.empty()) out.values.push_back({node.line, located(node, full), ": " + words});
  }

  void inside(const CaseNode& node, const Form& form, const std::string& kind,
              const std::string& full) {
    if (form.kind == Form::Kind::table) table(node, kind, full);
    if (form.kind != Form::Kind::tables) return;
    const std::vector<std::string> paths = entry_paths(node, full);
    for (size_t i = 0; i < node.entries.size(); ++i) table(node.entries[i], kind, paths[i]);
  }

  /// Reports a key that every table of the kind must have, unless the table has it misspelt.
  void missing(const CaseNode& node, const std::string& name, const Declared& declared,
               const std::vector<std::string>& strange, const std::string& path) {
    const Key& key = *declared.front();
    const bool needed = declared.size() == 1 && key.is_needed() && key.condition.empty();
    if (!needed || name == "*" || node.find(name) || !nearest(name, strange).empty()) return;
    const std::string full = path.empty() ? name : path + "." + name;
    out.missing.push_back({node.line, node.location + ": " + full + " is missing",
                           ": " + allowed(CaseNode(), key.forms.front(), full)});
  }

  const std::map<std::string, KeysOfTable> book_ = keys_by_table();
};

}  // namespace

std::optional<double> read_number(const CaseNode& node, const Quantity& quantity) {
  if (!is_number(node) || !unit_fits(node, quantity)) return {};
  return quantity.holds(node.number) ? std::optional(node.number) : std::nullopt;
}

std::string refusal_of_number(const CaseNode& node, const Quantity& quantity) {
  for (const CaseNode& entry : node.entries)
    if (std::string out = refusal_of_number(entry, quantity); !out.empty()) return out;
  const bool misfit = is_number(node) && !unit_fits(node, quantity);
  if (!misfit && node.problem.empty()) return "";
  const std::string why =
      misfit ? "the unit '" + node.unit + "' of '" + node.text + "' does not fit" : node.problem;
  const std::string units = read_unit(quantity.unit)
                                ? "a number with a unit (" + units_like(quantity.unit) + ") or "
                                : "";
  return "; " + why + "; in quotes, " + units + "a formula of the constants is allowed";
}

std::optional<int> read_integer(const CaseNode& node, const Form& form) {
  if (node.kind != Kind::integer || node.integer < form.lower || node.integer > form.upper)
    return {};
  return static_cast<int>(node.integer);
}

std::optional<std::string> read_text(const CaseNode& node) {
  return node.kind == Kind::text ? std::optional(node.text) : std::nullopt;
}

std::string whole_number(const Form& form) {
  const std::string start = form.quantity.noun + " is a whole number ";
  if (form.upper == std::numeric_limits<int>::max())
    return start + "of at least " + to_text(form.lower);
  return start + "between " + to_text(form.lower) + " and " + to_text(form.upper);
}

std::string list_of(const Form& form) {
  std::string count;
  if (form.count() > 0)
    count = " of " + to_text(form.count());
  else if (form.most > 0)
    count = " of " + to_text(form.least) + " to " + to_text(form.most);
  else if (form.least > 1)
    count = " of at least " + to_text(form.least);
  return "a list" + count + ": ";
}

std::string number_or_name(const Form& form) {
  return form.quantity.allowed() + ", or the name of " + form.or_name;
}

std::string one_of(const std::string& noun, std::span<const std::string> allowed) {
  if (allowed.empty()) return noun + " is allowed here, but this case has none";
  std::string text = noun + (allowed.size() == 1 ? " is " : " is one of ");
  for (size_t i = 0; i < allowed.size(); ++i) text += (i ? ", '" : "'") + allowed[i] + "'";
  return text;
}

std::string one_of(const std::string& noun, std::span<const std::string> allowed,
                   const std::string& found) {
  const std::string close = allowed.size() > 1 ? nearest(found, allowed) : "";
  return one_of(noun, allowed) + (close.empty() ? "" : ", did you mean '" + close + "'?");
}

std::string complaints_text(std::vector<Complaint> complaints, const std::string& file) {
  std::stable_sort(complaints.begin(), complaints.end(),
                   [](const Complaint& a, const Complaint& b) { return a.line < b.line; });
  // Twenty lines fit on a screen. A longer list usually has one common cause.
  constexpr size_t kMaxListed = 20;
  const size_t n = complaints.size(), shown = n > kMaxListed ? kMaxListed - 1 : n;
  std::string all;
  for (size_t i = 0; i < shown; ++i)
    all += (i ? "\n" : "") + complaints[i].subject + complaints[i].words;
  if (shown < n)
    all +=
        "\n" + file + ": " + to_text(static_cast<int>(n - shown)) + " more errors are not listed";
  return all;
}

BookCheck check_by_book(const CaseNode& root) {
  BookReader reader;
  reader.table(root, "", "");
  return std::move(reader.out);
}

}  // namespace flexmorph::io
