#include "io/case_file.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "io/case_document.h"
#include "io/files.h"

namespace flexmorph::io {

/// Where a Table stands: shared by its copies, keeps the document alive.
struct Table::Place {
  std::shared_ptr<CaseDocument> document;
  const CaseNode* table;
  std::string path;
  std::string kind;  ///< the path without names and indices, as keys are declared for it

  std::string full(const std::string& key) const { return path.empty() ? key : path + "." + key; }

  /// The node of a key, or nullptr; the key is known from now on.
  const CaseNode* find(const std::string& key) const {
    table->visited = true;
    table->asked.insert(key);
    return table->find(key);
  }

  /// @throws Error (input): a missing key, or the misspelt one that was probably meant.
  [[noreturn]] void fail_missing(const std::string& key, const std::string& allowed) const {
    std::vector<std::string> unasked;
    for (const CaseNode& node : table->entries)
      if (!table->asked.contains(node.key)) unasked.push_back(node.key);
    const std::string misspelt = nearest(key, unasked);
    if (!misspelt.empty())
      throw Error::input(located(*table->find(misspelt), full(misspelt)) +
                         ": unknown key, did you mean '" + key + "'?");
    throw Error::input(table->place + ": " + full(key) + " is missing: " + allowed);
  }

  [[noreturn]] void fail(const std::string& key, const std::string& allowed) const {
    const CaseNode* node = find(key);
    if (!node) fail_missing(key, allowed);
    throw Error::input(located(*node, full(key)) + ": " + allowed);
  }

  /// All entries of a list, each through `read`, which returns nothing for a wrong one.
  template <class T, class Read>
  std::vector<T> list(const std::string& key, const std::string& allowed, int count,
                      const std::optional<std::vector<T>>& fallback, Read read) const {
    const std::string each =
        (count ? "a list of " + std::to_string(count) + ": " : "a list: ") + allowed;
    const CaseNode* node = find(key);
    if (!node && fallback) return *fallback;
    if (!node) fail_missing(key, each);
    const size_t size = node->entries.size();
    if (node->kind != CaseNode::Kind::list || size == 0 || (count && size != size_t(count)))
      fail(key, each);
    std::vector<T> values;
    for (const CaseNode& entry : node->entries) {
      const std::optional<T> value = read(entry);
      if (!value) fail(key, each);
      values.push_back(*value);
    }
    return values;
  }
};

namespace {

using Kind = CaseNode::Kind;

/// The value that a key is declared with, if any.
template <class T>
std::optional<T> fallback_of(const Key& key) {
  if (!key.fallback) return {};
  if constexpr (std::is_same_v<T, double>)
    if (const int* whole = std::get_if<int>(&*key.fallback)) return *whole;
  return std::get<T>(*key.fallback);
}

std::optional<double> read_number(const CaseNode& node, const Quantity& quantity) {
  if (node.kind != Kind::number && node.kind != Kind::integer) return {};
  return quantity.holds(node.number) ? std::optional(node.number) : std::nullopt;
}

std::optional<int> read_integer(const CaseNode& node, int lower, int upper) {
  if (node.kind != Kind::integer || node.integer < lower || node.integer > upper) return {};
  return static_cast<int>(node.integer);
}

std::string whole_number(const std::string& noun, int lower, int upper) {
  const std::string start = noun + " is a whole number ";
  if (upper == std::numeric_limits<int>::max()) return start + "of at least " + to_text(lower);
  return start + "between " + to_text(lower) + " and " + to_text(upper);
}

std::string one_of(const std::string& noun, std::span<const std::string> allowed) {
  if (allowed.empty()) return noun + ": this case has none";
  std::string text = noun + (allowed.size() == 1 ? " is " : " is one of ");
  for (size_t i = 0; i < allowed.size(); ++i) text += (i ? ", '" : "'") + allowed[i] + "'";
  return text;
}

}  // namespace

const std::string& Table::path() const { return place_->path; }

std::string Table::place() const { return place_->table->place; }

bool Table::has(const std::string& key) const { return place_->find(key) != nullptr; }

bool Table::is_string(const std::string& key) const {
  const CaseNode* node = place_->find(key);
  return node != nullptr && node->kind == CaseNode::Kind::text;
}

bool Table::is_list_of_strings(const std::string& key) const {
  const CaseNode* node = place_->find(key);
  return node != nullptr && node->kind == Kind::list && !node->entries.empty() &&
         std::all_of(node->entries.begin(), node->entries.end(),
                     [](const CaseNode& entry) { return entry.kind == Kind::text; });
}

std::vector<std::string> Table::keys() const {
  std::vector<std::string> all;
  for (const CaseNode& node : place_->table->entries) all.push_back(node.key);
  return all;
}

double Table::number(const std::string& key, const Quantity& quantity,
                     std::optional<double> fallback) const {
  const CaseNode* node = place_->find(key);
  if (!node && fallback) return *fallback;
  const std::optional<double> value = node ? read_number(*node, quantity) : std::nullopt;
  if (!value && node && node->kind == Kind::text)
    fail(key, quantity.allowed() + "; a number stands without quotes");
  if (!value) fail(key, quantity.allowed());
  return *value;
}

int Table::integer(const std::string& key, const std::string& noun, int lower, int upper,
                   std::optional<int> fallback) const {
  const CaseNode* node = place_->find(key);
  if (!node && fallback) return *fallback;
  const std::optional<int> value = node ? read_integer(*node, lower, upper) : std::nullopt;
  if (!value) fail(key, whole_number(noun, lower, upper));
  return *value;
}

bool Table::boolean(const std::string& key, std::optional<bool> fallback) const {
  const CaseNode* node = place_->find(key);
  if (!node && fallback) return *fallback;
  if (!node || node->kind != Kind::boolean) fail(key, "true or false");
  return node->integer != 0;
}

std::string Table::string(const std::string& key, const std::string& noun,
                          std::optional<std::string> fallback) const {
  const CaseNode* node = place_->find(key);
  if (!node && fallback) return *fallback;
  if (!node || node->kind != Kind::text) fail(key, noun + " is a text in quotes");
  return node->text;
}

std::string Table::choice(const std::string& key, const std::string& noun,
                          std::span<const std::string> allowed,
                          std::optional<std::string> fallback) const {
  const CaseNode* node = place_->find(key);
  if (!node && fallback) return *fallback;
  const std::string text = one_of(noun, allowed);
  if (!node || node->kind != Kind::text) fail(key, text);
  std::string value = node->text;
  for (const std::string& name : allowed)
    if (value == name) return value;
  const std::string close = nearest(value, allowed);
  fail(key, close.empty() ? text : text + ", did you mean '" + close + "'?");
}

std::vector<double> Table::numbers(const std::string& key, const Quantity& each, int count,
                                   const std::optional<std::vector<double>>& fallback) const {
  return place_->list<double>(key, each.allowed(), count, fallback,
                              [&](const CaseNode& node) { return read_number(node, each); });
}

std::vector<int> Table::integers(const std::string& key, const std::string& noun, int lower,
                                 int upper, int count,
                                 const std::optional<std::vector<int>>& fallback) const {
  return place_->list<int>(key, whole_number(noun, lower, upper), count, fallback,
                           [&](const CaseNode& node) { return read_integer(node, lower, upper); });
}

std::vector<std::vector<double>> Table::rows(const std::string& key, const Quantity& each,
                                             int columns) const {
  using Row = std::vector<double>;
  const std::string row = "lists of " + to_text(columns) + " numbers; " + each.allowed();
  return place_->list<Row>(key, row, 0, {}, [&](const CaseNode& node) -> std::optional<Row> {
    if (node.kind != Kind::list || node.entries.size() != static_cast<size_t>(columns)) return {};
    Row out;
    for (const CaseNode& entry : node.entries) {
      const std::optional<double> value = read_number(entry, each);
      if (!value) return {};
      out.push_back(*value);
    }
    return out;
  });
}

std::vector<std::string> Table::choices(const std::string& key, const std::string& noun,
                                        std::span<const std::string> allowed) const {
  std::set<std::string> seen;
  return place_->list<std::string>(
      key, one_of(noun, allowed) + ", none twice", 0, {},
      [&](const CaseNode& node) -> std::optional<std::string> {
        const bool known = node.kind == Kind::text &&
                           std::find(allowed.begin(), allowed.end(), node.text) != allowed.end();
        return known && seen.insert(node.text).second ? std::optional(node.text) : std::nullopt;
      });
}

std::vector<std::string> Table::strings(const std::string& key, const std::string& noun) const {
  return place_->list<std::string>(
      key, noun, 0, {}, [](const CaseNode& node) -> std::optional<std::string> {
        return node.kind == Kind::text ? std::optional(node.text) : std::nullopt;
      });
}

Table Table::table(const std::string& key) const { return open_table(key, key); }

std::vector<Table> Table::tables(const std::string& key) const { return open_tables(key, key); }

Table Table::open_table(const std::string& key, const std::string& kind) const {
  const CaseNode* node = place_->find(key);
  const std::string full = place_->full(key);
  if (!node || node->kind != Kind::table) fail(key, "[" + full + "] is a table");
  return opened(*node, full, kind);
}

Table Table::opened(const CaseNode& node, const std::string& path, const std::string& kind) const {
  node.visited = true;
  const std::string& above = place_->kind;
  return Table(std::make_shared<Place>(
      Place{place_->document, &node, path, above.empty() ? kind : above + "." + kind}));
}

std::vector<Table> Table::open_tables(const std::string& key, const std::string& kind) const {
  const CaseNode* node = place_->find(key);
  std::vector<Table> entries;
  if (!node) return entries;
  const std::string full = place_->full(key);
  const std::string allowed = "a list of tables, each under its own [[" + full + "]]";
  if (node->kind != CaseNode::Kind::list) fail(key, allowed);
  for (size_t i = 0; i < node->entries.size(); ++i) {
    const CaseNode* entry = &node->entries[i];
    if (entry->kind != CaseNode::Kind::table) fail(key, allowed);
    entries.push_back(opened(*entry, entry_path(*node, i, full), kind));
  }
  return entries;
}

/// The form to read by. @throws std::logic_error for a key of another table, or of another form.
const Form& Table::use(const Key& key, Form::Kind kind, bool is_list) const {
  if (std::find(key.tables.begin(), key.tables.end(), place_->kind) == key.tables.end())
    throw std::logic_error("key '" + key.name + "' is read in [" + place_->kind +
                           "], which it is not declared for");
  return key.form(kind, is_list);
}

void Table::settle(const Key& key, const Value& value) const {
  const bool is_missing = place_->find(key.name) == nullptr;
  place_->table->note(key.name, key.sentence, is_missing ? toml_text(value) : "");
}

void Table::fail(const Key& key, const std::string& allowed) const { fail(key.name, allowed); }

bool Table::has(const Key& key) const { return has(key.name); }

bool Table::is_string(const Key& key) const { return is_string(key.name); }

bool Table::is_list_of_strings(const Key& key) const { return is_list_of_strings(key.name); }

double Table::number(const Key& key, std::optional<double> computed) const {
  const Form& form = use(key, Form::Kind::number);
  if (!computed) computed = fallback_of<double>(key);
  const double value = number(key.name, form.quantity, computed);
  settle(key, value);
  return value;
}

int Table::integer(const Key& key, std::optional<int> computed) const {
  const Form& form = use(key, Form::Kind::integer);
  if (!computed) computed = fallback_of<int>(key);
  const int value = integer(key.name, form.quantity.noun, form.lower, form.upper, computed);
  settle(key, value);
  return value;
}

bool Table::boolean(const Key& key, std::optional<bool> computed) const {
  use(key, Form::Kind::boolean);
  if (!computed) computed = fallback_of<bool>(key);
  const bool value = boolean(key.name, computed);
  settle(key, value);
  return value;
}

std::string Table::string(const Key& key, std::optional<std::string> computed) const {
  const Form& form = use(key, Form::Kind::text);
  if (!computed) computed = fallback_of<std::string>(key);
  const std::string value = string(key.name, form.quantity.noun, computed);
  settle(key, value);
  return value;
}

std::string Table::choice(const Key& key) const {
  return choice(key, key.form(Form::Kind::word).words());
}

std::string Table::choice(const Key& key, std::span<const std::string> allowed,
                          std::optional<std::string> computed) const {
  const Form& form = use(key, Form::Kind::word);
  if (!computed) computed = fallback_of<std::string>(key);
  const std::string value = choice(key.name, form.quantity.noun, allowed, computed);
  settle(key, value);
  return value;
}

std::vector<double> Table::numbers(const Key& key,
                                   const std::optional<std::vector<double>>& computed) const {
  const Form& form = use(key, Form::Kind::number, true);
  const std::vector<double> value =
      numbers(key.name, form.quantity, form.count(),
              computed ? computed : fallback_of<std::vector<double>>(key));
  settle(key, value);
  return value;
}

std::vector<int> Table::integers(const Key& key,
                                 const std::optional<std::vector<int>>& computed) const {
  const Form& form = use(key, Form::Kind::integer, true);
  const std::vector<int> value =
      integers(key.name, form.quantity.noun, form.lower, form.upper, form.count(),
               computed ? computed : fallback_of<std::vector<int>>(key));
  settle(key, value);
  return value;
}

std::vector<std::vector<double>> Table::rows(const Key& key) const {
  const Form& form = use(key, Form::Kind::number, true);
  place_->table->note(key.name, key.sentence, "");
  return rows(key.name, form.quantity, form.columns);
}

std::vector<std::string> Table::choices(const Key& key) const {
  return choices(key, key.form(Form::Kind::word, true).words());
}

std::vector<std::string> Table::choices(const Key& key,
                                        std::span<const std::string> allowed) const {
  const Form& form = use(key, Form::Kind::word, true);
  place_->table->note(key.name, key.sentence, "");
  return choices(key.name, form.quantity.noun, allowed);
}

std::vector<std::string> Table::strings(const Key& key) const {
  const Form& form = use(key, Form::Kind::text, true);
  place_->table->note(key.name, key.sentence, "");
  return strings(key.name, form.quantity.noun);
}

Table Table::table(const Key& key) const {
  use(key, Form::Kind::table);
  Table out = open_table(key.name, key.is_named ? "*" : key.name);
  place_->table->note(key.name, key.sentence, "");
  return out;
}

Table Table::table_or_empty(const Key& key) const {
  if (has(key)) return table(key);
  use(key, Form::Kind::table);
  const CaseNode& parent = *place_->table;
  parent.note(key.name, key.sentence, "");
  auto node = std::find_if(parent.assumed.begin(), parent.assumed.end(),
                           [&](const CaseNode& each) { return each.key == key.name; });
  if (node == parent.assumed.end()) {
    node = parent.assumed.emplace(parent.assumed.end());
    node->key = key.name;
    node->place = parent.place;
  }
  return opened(*node, place_->full(key.name), key.name);
}

std::vector<Table> Table::tables(const Key& key) const {
  use(key, Form::Kind::tables);
  place_->table->note(key.name, key.sentence, "");
  return open_tables(key.name, key.name);
}

std::string Table::beside(const std::string& name) const {
  return (std::filesystem::path(place_->document->path).parent_path() / name).string();
}

void Table::fail(const std::string& key, const std::string& allowed) const {
  place_->fail(key, allowed);
}

void Table::fail(const std::string& allowed) const {
  const std::string path = place_->path.empty() ? "" : place_->path + ": ";
  throw Error::input(place_->table->place + ": " + path + allowed);
}

CaseFile::CaseFile(const std::string& path, std::span<const std::string> overrides) {
  auto document = std::make_shared<CaseDocument>(path);
  for (const std::string& change : overrides) document->apply(change);
  const CaseNode* root = &document->root;
  root->visited = true;
  root_ = std::make_shared<Table::Place>(Table::Place{std::move(document), root, "", ""});
}

const std::string& CaseFile::path() const { return root_->document->path; }

Table CaseFile::root() const { return Table(root_); }

void CaseFile::finish() const { root_->document->refuse_unknown_keys(); }

std::string CaseFile::text() const { return root_->document->effective_text(); }

std::string CaseFile::explained() const { return root_->document->explained_text(); }

}  // namespace flexmorph::io
