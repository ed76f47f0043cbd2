#include "io/case_files/case_file.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "io/case_files/case_forms.h"
#include "io/case_files/case_location.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

using Kind = CaseNode::Kind;

}  // namespace

void Table::Location::fail_missing(const std::string& key, const std::string& allowed) const {
  std::vector<std::string> unasked;
  for (const CaseNode& node : table->entries)
    if (!table->asked.contains(node.key)) unasked.push_back(node.key);
  const std::string misspelt = nearest(key, unasked);
  if (!misspelt.empty())
    throw Error::input(located(*table->find(misspelt), full(misspelt)) +
                       ": unknown key, did you mean '" + key + "'?");
  throw Error::input(table->location + ": " + full(key) + " is missing: " + allowed);
}

void Table::Location::fail(const std::string& key, const std::string& allowed) const {
  const CaseNode* node = find(key);
  if (!node) fail_missing(key, allowed);
  throw Error::input(located(*node, full(key)) + ": " + allowed);
}

const Form& Table::Location::form(const Key& key, Form::Kind wanted, bool is_list) const {
  if (std::find(key.tables.begin(), key.tables.end(), kind) == key.tables.end())
    throw std::logic_error("key '" + key.name + "' is read in [" + kind +
                           "], for which it is not declared");
  return key.form(wanted, is_list);
}

const std::string& Table::path() const { return location_->path; }

std::string Table::location() const { return location_->table->location; }

std::vector<std::string> Table::keys() const {
  std::vector<std::string> all;
  for (const CaseNode& node : location_->table->entries) all.push_back(node.key);
  return all;
}

bool Table::has(const Key& key) const { return location_->find(key.name) != nullptr; }

bool Table::is_string(const Key& key) const {
  const CaseNode* node = location_->find(key.name);
  return node != nullptr && node->kind == Kind::text;
}

bool Table::says_one_of(const Key& key, std::span<const std::string> words) const {
  const CaseNode* node = location_->find(key.name);
  return node != nullptr && node->kind == Kind::text &&
         std::find(words.begin(), words.end(), node->text) != words.end();
}

bool Table::is_list_of_strings(const Key& key) const {
  const CaseNode* node = location_->find(key.name);
  return node != nullptr && node->kind == Kind::list && !node->entries.empty() &&
         std::all_of(node->entries.begin(), node->entries.end(),
                     [](const CaseNode& entry) { return entry.kind == Kind::text; });
}

double Table::number(const Key& key, std::optional<double> computed) const {
  const Quantity& quantity = location_->form(key, Form::Kind::number).quantity;
  return location_->value<double>(key, computed, quantity.allowed(), [&](const CaseNode& node) {
    return read_number(node, quantity);
  });
}

int Table::integer(const Key& key, std::optional<int> computed) const {
  const Form& form = location_->form(key, Form::Kind::integer);
  return location_->value<int>(key, computed, whole_number(form),
                               [&](const CaseNode& node) { return read_integer(node, form); });
}

bool Table::boolean(const Key& key, std::optional<bool> computed) const {
  location_->form(key, Form::Kind::boolean);
  return location_->value<bool>(
      key, computed, "true or false", [](const CaseNode& node) -> std::optional<bool> {
        return node.kind == Kind::boolean ? std::optional(node.integer != 0) : std::nullopt;
      });
}

std::string Table::string(const Key& key, const std::optional<std::string>& computed) const {
  const Form& form = location_->form(key, Form::Kind::text);
  return location_->value<std::string>(key, computed, form.quantity.noun + " is a text in quotes",
                                       read_text);
}

std::string Table::choice(const Key& key, const std::optional<std::string>& computed) const {
  return choice(key, key.form(Form::Kind::word).words(), computed);
}

std::string Table::choice(const Key& key, std::span<const std::string> allowed,
                          const std::optional<std::string>& computed) const {
  const std::string& noun = location_->form(key, Form::Kind::word).quantity.noun;
  const auto read = [&](const CaseNode& node) -> std::optional<std::string> {
    if (node.kind != Kind::text) return {};
    if (std::find(allowed.begin(), allowed.end(), node.text) != allowed.end()) return node.text;
    fail(key, one_of(noun, allowed, node.text) + refusal_of_number(node, {}));
  };
  return location_->value<std::string>(key, computed, one_of(noun, allowed), read);
}

std::vector<double> Table::numbers(const Key& key,
                                   const std::optional<std::vector<double>>& computed) const {
  const Form& form = location_->form(key, Form::Kind::number, true);
  return location_->list<double>(
      key, form, form.quantity.allowed(), computed,
      [&](const CaseNode& node) { return read_number(node, form.quantity); });
}

std::vector<NumberOrName> Table::numbers_or_names(const Key& key,
                                                  std::span<const std::string> allowed) const {
  const Form& form = location_->form(key, Form::Kind::number, true);
  const auto read = [&](const CaseNode& node) -> std::optional<NumberOrName> {
    if (const auto number = read_number(node, form.quantity)) return NumberOrName{{}, *number};
    if (node.kind != Kind::text) return {};
    if (std::find(allowed.begin(), allowed.end(), node.text) == allowed.end())
      fail(key, one_of(form.or_name, allowed, node.text));
    return NumberOrName{node.text, 0};
  };
  return location_->list<NumberOrName>(key, form, number_or_name(form), {}, read);
}

std::vector<int> Table::integers(const Key& key,
                                 const std::optional<std::vector<int>>& computed) const {
  const Form& form = location_->form(key, Form::Kind::integer, true);
  return location_->list<int>(key, form, whole_number(form), computed,
                              [&](const CaseNode& node) { return read_integer(node, form); });
}

std::vector<std::vector<double>> Table::rows(const Key& key) const {
  using Row = std::vector<double>;
  const Form& form = location_->form(key, Form::Kind::number, true);
  const std::string row =
      "lists of " + to_text(form.columns) + " numbers; " + form.quantity.allowed();
  const auto read = [&](const CaseNode& node) -> std::optional<Row> {
    if (node.kind != Kind::list || node.entries.size() != static_cast<size_t>(form.columns))
      return {};
    Row out;
    for (const CaseNode& entry : node.entries) {
      const std::optional<double> value = read_number(entry, form.quantity);
      if (!value) return {};
      out.push_back(*value);
    }
    return out;
  };
  return location_->list<Row>(key, form, row, {}, read);
}

std::vector<std::string> Table::choices(const Key& key) const {
  return choices(key, key.form(Form::Kind::word, true).words());
}

std::vector<std::string> Table::choices(const Key& key,
                                        std::span<const std::string> allowed) const {
  const Form& form = location_->form(key, Form::Kind::word, true);
  std::set<std::string> seen;
  const auto read = [&](const CaseNode& node) -> std::optional<std::string> {
    const bool known = node.kind == Kind::text &&
                       std::find(allowed.begin(), allowed.end(), node.text) != allowed.end();
    return known && seen.insert(node.text).second ? std::optional(node.text) : std::nullopt;
  };
  return location_->list<std::string>(
      key, form, one_of(form.quantity.noun, allowed) + ", each name at most once", {}, read);
}

std::vector<std::string> Table::strings(const Key& key) const {
  const Form& form = location_->form(key, Form::Kind::text, true);
  return location_->list<std::string>(key, form, form.quantity.noun, {}, read_text);
}

Table Table::opened(const CaseNode& node, const std::string& path, const std::string& kind) const {
  node.visited = true;
  const std::string& above = location_->kind;
  return Table(std::make_shared<Location>(
      Location{location_->document, &node, path, above.empty() ? kind : above + "." + kind}));
}

Table Table::table(const Key& key) const {
  location_->form(key, Form::Kind::table);
  location_->note(key, "");
  const CaseNode* node = location_->find(key.name);
  const std::string full = location_->full(key.name);
  if (!node || node->kind != Kind::table) fail(key, "[" + full + "] is a table");
  return opened(*node, full, key.is_named ? "*" : key.name);
}

Table Table::table_or_empty(const Key& key) const {
  if (has(key)) return table(key);
  location_->form(key, Form::Kind::table);
  location_->note(key, "");
  const CaseNode& parent = *location_->table;
  auto node = std::find_if(parent.assumed.begin(), parent.assumed.end(),
                           [&](const CaseNode& each) { return each.key == key.name; });
  if (node == parent.assumed.end()) {
    node = parent.assumed.emplace(parent.assumed.end());
    node->key = key.name;
    node->location = parent.location;
  }
  return opened(*node, location_->full(key.name), key.name);
}

std::vector<Table> Table::tables(const Key& key) const {
  location_->form(key, Form::Kind::tables);
  location_->note(key, "");
  const CaseNode* node = location_->find(key.name);
  std::vector<Table> entries;
  if (!node) return entries;
  const std::string full = location_->full(key.name);
  const std::string allowed = "a list of tables, each with the heading [[" + full + "]]";
  if (node->kind != Kind::list) fail(key, allowed);
  const std::vector<std::string> paths = entry_paths(*node, full);
  for (size_t i = 0; i < node->entries.size(); ++i) {
    const CaseNode& entry = node->entries[i];
    if (entry.kind != Kind::table) fail(key, allowed);
    entries.push_back(opened(entry, paths[i], key.name));
  }
  return entries;
}

void Table::record(const Key& key, const Value& value) const {
  location_->note(key, location_->find(key.name) ? "" : toml_text(value));
}

std::string Table::path_of(const Key& key) const {
  std::string name = string(key);
  const CaseNode* node = location_->find(key.name);
  if (node != nullptr && node->is_option) return name;
  return (std::filesystem::path(location_->document->path).parent_path() / name).string();
}

std::string Table::absolute(const Key& key) const {
  return std::filesystem::absolute(path_of(key)).string();
}

std::string Table::subject_of(const Key& key) const {
  const CaseNode* node = location_->find(key.name);
  const std::string full = location_->full(key.name);
  return node ? io::located(*node, full) : location() + ": " + full;
}

void Table::fail(const Key& key, const std::string& allowed) const {
  location_->fail(key.name, allowed);
}

void Table::fail(const std::string& allowed) const {
  const std::string path = location_->path.empty() ? "" : location_->path + ": ";
  throw Error::input(location_->table->location + ": " + path + allowed);
}

CaseFile::CaseFile(const std::string& path, std::span<const std::string> overrides)
    : CaseFile(std::make_shared<CaseDocument>(path), overrides) {}

CaseFile CaseFile::of_text(const std::string& text, const std::string& path,
                           std::span<const std::string> overrides) {
  return CaseFile(std::make_shared<CaseDocument>(path, text), overrides);
}

CaseFile::CaseFile(std::shared_ptr<CaseDocument> document, std::span<const std::string> overrides) {
  document->rename_former_names();
  for (const std::string& change : overrides) {
    document->apply(change);
    document->rename_former_names();
  }
  document->read_number_texts();
  const CaseNode* root = &document->root;
  root->visited = true;
  root_ = std::make_shared<Table::Location>(Table::Location{std::move(document), root, "", ""});
}

const std::string& CaseFile::path() const { return root_->document->path; }

Table CaseFile::root() const { return Table(root_); }

std::string CaseFile::with_others(const std::string& complaint) const {
  BookCheck found = check_by_book(root_->document->root);
  bool known = false;
  const auto same = [&](const Complaint& each) {
    const bool is = complaint.starts_with(each.subject + ":");
    known = known || is;
    return is;
  };
  for (std::vector<Complaint>* list : {&found.values, &found.unknown, &found.missing})
    std::erase_if(*list, same);
  std::vector<Complaint> all = {{0, complaint, ""}};
  all.insert(all.end(), found.values.begin(), found.values.end());
  all.insert(all.end(), found.unknown.begin(), found.unknown.end());
  // Sections that do not fit together may be there by mistake; then messages about their missing
  // keys would not help.
  if (known) all.insert(all.end(), found.missing.begin(), found.missing.end());
  return complaints_text(std::move(all), path());
}

std::string CaseFile::where(const std::string& key_path) const {
  return root_->document->where(key_path);
}

bool CaseFile::gives(const std::string& key_path) const {
  return root_->document->look(key_path).whole;
}

const std::vector<std::string>& CaseFile::former_names() const {
  return root_->document->former_names;
}

std::vector<Setting> CaseFile::settings() const { return root_->document->settings(); }

std::vector<Setting> CaseFile::dependent_settings() const {
  return root_->document->dependent_settings();
}

std::vector<Setting> CaseFile::values() const { return root_->document->values(); }

void CaseFile::finish() const { root_->document->refuse_unknown_keys(); }

namespace {

CaseDocument changed(CaseDocument document, std::span<const std::string> overrides) {
  for (const std::string& change : overrides) document.apply(change);
  return document;
}

}  // namespace

std::string CaseFile::text(std::span<const std::string> overrides) const {
  return changed(*root_->document, overrides).effective_text();
}

std::string CaseFile::explained(std::span<const std::string> overrides) const {
  return changed(*root_->document, overrides).explained_text();
}

}  // namespace flexmorph::io
