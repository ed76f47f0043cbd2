#include "io/case_files/key.h"

#include <stdexcept>

#include "io/case_files/case_parser.h"
#include "io/files.h"

namespace flexmorph::io {
namespace {

using Kind = Form::Kind;

std::deque<Key>& book() {
  static std::deque<Key> keys;
  return keys;
}

template <class T>
std::string list_text(const std::vector<T>& values) {
  std::string text;
  for (const T& each : values) text += (text.empty() ? "" : ", ") + to_text(each);
  return "[" + text + "]";
}

std::function<Words()> always(Words words) {
  return [words = std::move(words)] { return words; };
}

std::function<Words()> first_of(std::function<Glossary()> rows) {
  return [rows = std::move(rows)] {
    Words words;
    for (const auto& [word, sentence] : rows()) words.push_back(word);
    return words;
  };
}

Quantity only(std::string noun) { return {.noun = std::move(noun)}; }

}  // namespace

std::string toml_text(const Value& value) {
  struct {
    std::string operator()(bool x) const { return x ? "true" : "false"; }
    std::string operator()(int x) const { return to_text(x); }
    std::string operator()(double x) const { return to_text(x); }
    std::string operator()(const std::string& x) const { return in_quotes(x); }
    std::string operator()(const std::vector<double>& x) const { return list_text(x); }
    std::string operator()(const std::vector<int>& x) const { return list_text(x); }
  } writer;
  return std::visit(writer, value);
}

Key& Key::add(Form form) {
  forms.push_back(std::move(form));
  return *this;
}

Key& Key::number(Quantity quantity) {
  return add({.kind = Kind::number, .quantity = std::move(quantity)});
}

Key& Key::integer(std::string noun, int lower, int upper) {
  return add(
      {.kind = Kind::integer, .quantity = only(std::move(noun)), .lower = lower, .upper = upper});
}

Key& Key::boolean() { return add({.kind = Kind::boolean}); }

Key& Key::text(std::string noun) {
  return add({.kind = Kind::text, .quantity = only(std::move(noun))});
}

Key& Key::word(std::string noun, Words allowed) {
  return word(std::move(noun), always(std::move(allowed)));
}

Key& Key::word(std::string noun, std::function<Words()> allowed) {
  return add(
      {.kind = Kind::word, .quantity = only(std::move(noun)), .allowed = std::move(allowed)});
}

Key& Key::word(std::string noun, std::function<Glossary()> rows) {
  meanings = rows;
  return word(std::move(noun), first_of(std::move(rows)));
}

Key& Key::name_of(std::string noun) {
  return add({.kind = Kind::word, .quantity = only(std::move(noun))});
}

Key& Key::numbers(Quantity each, int least, int most) {
  return add({.kind = Kind::number,
              .quantity = std::move(each),
              .is_list = true,
              .least = least,
              .most = most});
}

Key& Key::numbers_or_names(Quantity each, std::string noun, int least, int most) {
  return add({.kind = Kind::number,
              .quantity = std::move(each),
              .is_list = true,
              .least = least,
              .most = most,
              .or_name = std::move(noun)});
}

Key& Key::integers(std::string noun, int lower, int upper, int least, int most) {
  return add({.kind = Kind::integer,
              .quantity = only(std::move(noun)),
              .lower = lower,
              .upper = upper,
              .is_list = true,
              .least = least,
              .most = most});
}

Key& Key::texts(std::string noun) {
  return add({.kind = Kind::text, .quantity = only(std::move(noun)), .is_list = true});
}

Key& Key::words(std::string noun, Words allowed) {
  return words(std::move(noun), always(std::move(allowed)));
}

Key& Key::words(std::string noun, std::function<Words()> allowed) {
  return add({.kind = Kind::word,
              .quantity = only(std::move(noun)),
              .allowed = std::move(allowed),
              .is_list = true});
}

Key& Key::words(std::string noun, std::function<Glossary()> rows) {
  meanings = rows;
  return words(std::move(noun), first_of(std::move(rows)));
}

Key& Key::names_of(std::string noun, int least, int most) {
  return add({.kind = Kind::word,
              .quantity = only(std::move(noun)),
              .is_list = true,
              .least = least,
              .most = most});
}

Key& Key::rows(Quantity each, int columns) {
  return add(
      {.kind = Kind::number, .quantity = std::move(each), .is_list = true, .columns = columns});
}

Key& Key::table() { return add({.kind = Kind::table}); }

Key& Key::tables_of() { return add({.kind = Kind::tables}); }

Key& Key::otherwise(Value value) {
  fallback = std::move(value);
  return *this;
}

Key& Key::otherwise_as(std::string words) {
  absence = std::move(words);
  return *this;
}

Key& Key::when(std::string words) {
  condition = std::move(words);
  return *this;
}

Key& Key::formerly(std::string name_of_last_version) {
  former_names.push_back(std::move(name_of_last_version));
  return *this;
}

Key& Key::renames(Glossary words_and_present_names) {
  renamings = std::move(words_and_present_names);
  return *this;
}

Key& Key::description(std::string words) {
  sentence = std::move(words);
  return *this;
}

const Form& Key::form(Form::Kind kind, bool is_list) const {
  for (const Form& form : forms)
    if (form.kind == kind && form.is_list == is_list) return form;
  throw std::logic_error("key '" + name + "' is read in a form for which it is not declared");
}

Key Key::within(double lower, double upper) const {
  Key out = *this;
  for (Form& form : out.forms) {
    form.quantity.lower = lower;
    form.quantity.upper = upper;
    if (form.kind != Kind::integer) continue;
    form.lower = static_cast<int>(lower);
    form.upper = static_cast<int>(upper);
  }
  return out;
}

Key Key::called(const std::string& noun) const {
  Key out = *this;
  for (Form& form : out.forms) form.quantity.noun = noun;
  return out;
}

Key Key::measured_in(const std::string& unit) const {
  Key out = *this;
  for (Form& form : out.forms) form.quantity.unit = unit;
  return out;
}

Key Key::counted(int entries) const {
  Key out = *this;
  for (Form& form : out.forms) form.least = form.most = entries;
  return out;
}

Key Key::named(std::string own) const {
  Key out = *this;
  out.name = std::move(own);
  out.is_named = true;
  return out;
}

Key& key(std::string table, std::string name, std::source_location location) {
  return shared_key({std::move(table)}, std::move(name), location);
}

Key& shared_key(std::vector<std::string> tables, std::string name, std::source_location location) {
  Key& out = book().emplace_back();
  out.tables = std::move(tables);
  out.name = std::move(name);
  out.location = location;
  return out;
}

const std::deque<Key>& all_keys() { return book(); }

}  // namespace flexmorph::io
