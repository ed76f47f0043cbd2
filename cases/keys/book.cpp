#include "cases/keys/book.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "cases/scene/body_keys.h"
#include "cases/scene/tables.h"
#include "geometry/base.h"
#include "geometry/text.h"
#include "io/case_files/case_document.h"
#include "io/files.h"

namespace flexmorph::cases {
namespace {

using Kind = io::Form::Kind;

constexpr const char* kTop = "top";

bool has(const io::Key& key, const std::string& table) {
  return std::find(key.tables.begin(), key.tables.end(), table) != key.tables.end();
}

bool is_table(const io::Key& key) {
  return std::any_of(key.forms.begin(), key.forms.end(), [](const io::Form& form) {
    return form.kind == Kind::table || form.kind == Kind::tables;
  });
}

/// Returns the rank of a key in its table: the name first, then the type, then all other keys.
int rank(const io::Key& key) {
  if (key.name == "name") return 0;
  return key.name == "type" || key.name == "element" ? 1 : 2;
}

/// Returns the path of the file that declares a key, from the folder cases/ on. The path before it
/// depends on how the compiler was called: absolute, or relative to the build folder with ccache.
std::string file_of(const io::Key& key) {
  const std::string path = key.location.file_name();
  const size_t at = path.rfind("cases/");
  return at == std::string::npos ? path : path.substr(at);
}

std::vector<const io::Key*> keys_of(const std::string& table) {
  std::vector<const io::Key*> out;
  for (const io::Key& key : io::all_keys())
    if (has(key, table)) out.push_back(&key);
  std::stable_sort(out.begin(), out.end(), [](const io::Key* a, const io::Key* b) {
    return std::make_tuple(rank(*a), file_of(*a), a->location.line(), a->location.column()) <
           std::make_tuple(rank(*b), file_of(*b), b->location.line(), b->location.column());
  });
  return out;
}

const io::Key* own_key(const std::string& path) {
  if (path.empty()) return nullptr;
  const size_t dot = path.rfind('.');
  const std::string above = dot == std::string::npos ? "" : path.substr(0, dot);
  const std::string name = dot == std::string::npos ? path : path.substr(dot + 1);
  for (const io::Key& key : io::all_keys())
    if (key.name == name && has(key, above) && is_table(key)) return &key;
  return nullptr;
}

std::vector<KeyTable> made_book() {
  declare_term_keys();
  std::vector<KeyTable> book;
  for (const std::string& path : tables::order()) {
    KeyTable table{{path}, keys_of(path), own_key(path)};
    if (table.keys.empty() || (!table.own && !path.empty()))
      throw std::logic_error("no source file of this program declares keys of [" + path + "]");
    if (!book.empty() && book.back().keys == table.keys)
      book.back().paths.push_back(path);
    else
      book.push_back(std::move(table));
  }
  return book;
}

/// Returns the limits of a quantity as text: "> 0", ">= 0 and <= 1", or an empty text.
std::string limits_text(const io::Quantity& q) {
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  std::string text;
  if (q.lower > -kUnlimited) text = (q.lower_open ? "> " : ">= ") + io::to_text(q.lower);
  if (q.upper < kUnlimited)
    text += (text.empty() ? "" : " and ") + std::string(q.upper_open ? "< " : "<= ") +
            io::to_text(q.upper);
  return text;
}

io::Quantity limits_of(const io::Form& form) {
  if (form.kind != Kind::integer) return form.quantity;
  io::Quantity q{.lower = static_cast<double>(form.lower)};
  if (form.upper < std::numeric_limits<int>::max()) q.upper = form.upper;
  return q;
}

std::string one_word(const io::Form& form) {
  std::string text;
  for (const std::string& word : form.words()) text += (text.empty() ? "\"" : ", \"") + word + "\"";
  return text;
}

/// Returns the type of a value as text: "number", for lists "numbers".
std::string value_text(const io::Form& form) {
  const std::string many = form.is_list ? "s" : "";
  switch (form.kind) {
    case Kind::number:
      return "number" + many;
    case Kind::integer:
      return "whole number" + many;
    case Kind::boolean:
      return "true or false";
    case Kind::text:
      return "text" + many;
    case Kind::table:
      return "table";
    case Kind::tables:
      return "list of tables";
    case Kind::word:
      break;
  }
  const std::string words = one_word(form);
  if (words.empty()) return "name" + many + " of " + form.quantity.noun;
  return form.is_list ? "one or more of " + words : words;
}

std::string form_text(const io::Form& form) {
  std::string text = value_text(form);
  if (form.columns > 0) {
    text = "rows of " + io::to_text(form.columns) + " " + text;
  } else if (form.is_list && form.most > 0) {
    text = io::to_text(form.least) +
           (form.most > form.least ? " or " + io::to_text(form.most) : "") + " " + text;
  } else if (form.is_list && !form.allowed) {
    text = "list of " + text;
  }
  const std::string limits = limits_text(limits_of(form));
  if (!limits.empty()) text += " " + limits;
  if (!form.quantity.unit.empty()) text += " [" + form.quantity.unit + "]";
  return form.or_name.empty() ? text : text + ", or names of " + form.or_name;
}

/// Returns the first table that has a key of the same name with the same explained words.
const KeyTable& first_with_words_of(const io::Key& key) {
  return *std::find_if(key_book().begin(), key_book().end(), [&](const KeyTable& table) {
    return std::any_of(table.keys.begin(), table.keys.end(), [&](const io::Key* other) {
      return other->name == key.name && other->meanings && other->meanings() == key.meanings();
    });
  });
}

}  // namespace

std::string KeyTable::title() const {
  std::string text;
  for (const std::string& path : paths) {
    std::string shown = path;
    if (const size_t star = shown.find('*'); star != std::string::npos)
      shown.replace(star, 1, "NAME");
    const bool many = own && std::any_of(own->forms.begin(), own->forms.end(),
                                         [](const io::Form& f) { return f.kind == Kind::tables; });
    if (path.empty())
      shown = "top of the file";
    else
      shown = many ? "[[" + shown + "]]" : "[" + shown + "]";
    text += (text.empty() ? "" : ", ") + shown;
  }
  return text;
}

const std::vector<KeyTable>& key_book() {
  static const std::vector<KeyTable> kBook = made_book();
  return kBook;
}

std::vector<std::string> key_table_names() {
  std::vector<std::string> out;
  for (const std::string& path : tables::order()) out.push_back(path.empty() ? kTop : path);
  return out;
}

const KeyTable& table_of_keys(const std::string& path) {
  const std::string wanted = path == kTop ? "" : path;
  for (const KeyTable& table : key_book())
    if (std::find(table.paths.begin(), table.paths.end(), wanted) != table.paths.end())
      return table;
  const std::vector<std::string> known = key_table_names();
  const std::string close = io::nearest(path, known);
  throw Error::input(
      "there is no table '" + path + "'" +
      (close.empty() ? "; the tables are " + joined(known) : ", did you mean '" + close + "'?"));
}

std::string type_text(const io::Key& key) {
  std::string text;
  for (const io::Form& form : key.forms) text += (text.empty() ? "" : ", or ") + form_text(form);
  return text;
}

std::string default_text(const io::Key& key) {
  if (key.fallback) return io::toml_text(*key.fallback);
  return key.absence.empty() ? "required" : key.absence;
}

std::string sentence_of(const io::Key& key) {
  return key.condition.empty() ? key.sentence : "(" + key.condition + ") " + key.sentence;
}

std::string WordMeanings::reference() const {
  return explained.empty() ? "" : "the words are explained under " + explained + ".";
}

std::vector<WordMeanings> meanings_of(const KeyTable& table) {
  std::vector<WordMeanings> out;
  for (const io::Key* key : table.keys) {
    if (!key->meanings) continue;
    const KeyTable& first = first_with_words_of(*key);
    const bool here = first.paths == table.paths;
    out.push_back({key->name, here ? key->meanings() : io::Glossary(), here ? "" : first.title()});
  }
  return out;
}

std::string shown_name(const io::Key& key) { return key.name == "*" ? "NAME" : key.name; }

}  // namespace flexmorph::cases
