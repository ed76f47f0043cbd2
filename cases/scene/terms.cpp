#include <map>
#include <mutex>

#include "cases/scene/body_keys.h"
#include "cases/scene/elements/row.h"
#include "cases/scene/read.h"

/// The terms of a body, and the numbers of the body that they need.
namespace flexmorph::cases {
namespace {

using io::Key;

/// Declares a number that a term needs as a key of [[body]].
const Key& declared(const fem::TermKey& key, const std::string& term) {
  Key& out =
      io::key("body", key.name).when("`terms` has \"" + term + "\"").description(key.sentence);
  if (key.whole) {
    out.integer(key.noun, static_cast<int>(key.low), static_cast<int>(key.high));
    if (key.fallback) out.otherwise(static_cast<int>(*key.fallback));
    return out;
  }
  out.number({key.noun, key.unit, key.low, key.high, key.low_open});
  if (key.fallback) out.otherwise(*key.fallback);
  return out;
}

using TermKeys = std::map<std::string, std::map<std::string, const Key*>>;

/// Returns the keys of all terms, by term and name. The keys of terms that were registered since
/// the last call are declared here.
const TermKeys& term_keys() {
  static TermKeys all;
  static std::mutex lock;
  const std::lock_guard guard(lock);
  for (const fem::TermRow* row : fem::term_rows()) {
    const auto [keys, is_new] = all.try_emplace(row->name);
    if (is_new)
      for (const fem::TermKey& key : row->keys) keys->second[key.name] = &declared(key, row->name);
  }
  return all;
}

io::Glossary all_terms() {
  io::Glossary rows;
  for (const fem::TermRow* row : fem::term_rows()) rows.emplace_back(row->name, row->sentence);
  return rows;
}

}  // namespace

const Key& body_keys::kTerms = io::key("body", "terms")
                                   .words("a term", all_terms)
                                   .description(
                                       "Terms of the equations of motion of the body. A term that "
                                       "is not listed does not act.");

void declare_term_keys() { term_keys(); }

void read_terms(const io::Table& t, const Scene& scene, Body& body) {
  const Key& key = body_keys::kTerms;
  body.terms = t.choices(key.called(body.row->term), fem::term_names(body.term_domain()));
  if (const std::string why = fem::refusal_of_terms(body.term_domain(), body.terms, !scene.statics);
      !why.empty())
    t.fail(key, why);
  for (const std::string& term : body.terms)
    for (const fem::TermKey& each : fem::term_row(term).keys) {
      const Key& number = *term_keys().at(term).at(each.name);
      body.numbers[each.name] = each.whole ? t.integer(number) : t.number(number);
    }
}

}  // namespace flexmorph::cases
