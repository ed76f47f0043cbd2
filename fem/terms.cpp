#include "fem/terms.h"

#include <algorithm>
#include <ranges>

#include "geometry/registry.h"
#include "geometry/text.h"

namespace flexmorph::fem {

const TermRow& bending_row();
const TermRow& damping_row();
const TermRow& ecm_row();
const TermRow& ecm_full_row();
const TermRow& gcm_row();
const TermRow& gcm_full_row();
const TermRow& inertia_row();
const TermRow& membrane_row();
const TermRow& membrane_assumed_row();

namespace {

Registry<TermRow>& registry() {
  static Registry<TermRow> all(
      "term", [](const TermRow& row) { return row.name; },
      {&inertia_row(), &bending_row(), &membrane_row(), &membrane_assumed_row(), &gcm_row(),
       &ecm_row(), &gcm_full_row(), &ecm_full_row(), &damping_row()});
  return all;
}

}  // namespace

std::span<const TermRow* const> term_rows() { return registry().rows(); }
void register_term(const TermRow& row) {
  if (!row.make) throw Error::input("term '" + row.name + "' has no make()");
  registry().add(row);
}

namespace {

std::string quoted(const std::string& name) { return '"' + name + '"'; }

/// Returns a list of quoted names: "a", "a or b", "a, b or c" for last = "or".
std::string listed(const std::vector<std::string>& names, const std::string& last) {
  std::string out;
  for (size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "" : i + 1 == names.size() ? " " + last + " " : ", ") + quoted(names[i]);
  return out;
}

/// Returns the names of the terms of a role for a kind of body.
std::vector<std::string> of_role(const std::string& role, TermDomain domain) {
  std::vector<std::string> out;
  for (const TermRow* row : term_rows())
    if (row->role == role && row->may_stand_in(domain)) out.push_back(row->name);
  return out;
}

/// Returns the roles that this kind of body requires, in the order of the table.
std::vector<std::string> required_roles(TermDomain domain) {
  std::vector<std::string> out;
  for (const TermRow* row : term_rows())
    if (std::find(row->required_in.begin(), row->required_in.end(), domain) !=
            row->required_in.end() &&
        std::find(out.begin(), out.end(), row->role) == out.end())
      out.push_back(row->role);
  return out;
}

const char* noun_of(TermDomain domain) {
  switch (domain) {
    case TermDomain::plane:
      return "a plate in the plane";
    case TermDomain::space:
      return "a plate in space";
    case TermDomain::beam:
      return "a beam";
  }
  return "";
}

}  // namespace

bool TermRow::may_stand_in(TermDomain domain) const {
  return std::find(domains.begin(), domains.end(), domain) != domains.end();
}

bool TermRow::reads(const std::string& key) const {
  return std::any_of(keys.begin(), keys.end(), [&](const TermKey& k) { return k.name == key; });
}

std::vector<std::string> term_names(TermDomain domain) {
  std::vector<std::string> out;
  for (const TermRow* row : term_rows())
    if (row->may_stand_in(domain)) out.push_back(row->name);
  return out;
}

const TermRow& term_row(const std::string& name) {
  if (const TermRow* row = registry().find(name)) return *row;
  throw Error::input("term '" + name + "' is unknown; the available terms are: " +
                     joined(std::views::transform(term_rows(), &TermRow::name)));
}

std::vector<std::string> alternatives(const TermRow& row, TermDomain domain) {
  std::vector<std::string> out = of_role(row.role, domain);
  std::erase(out, row.name);
  return out;
}

std::string refusal_of_terms(TermDomain domain, std::span<const std::string> names, bool moves) {
  std::vector<const TermRow*> rows;
  for (const std::string& name : names) {
    const TermRow& row = term_row(name);
    if (!row.may_stand_in(domain)) return quoted(name) + " is not available for " + noun_of(domain);
    for (const TermRow* other : rows)
      if (other->role == row.role)
        return quoted(row.name) + " and " + quoted(other->name) +
               " are alternatives; only one of them is allowed";
    rows.push_back(&row);
  }
  const auto has = [&](const std::string& role) {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const TermRow* row) { return row->role == role; });
  };
  const bool elastic =
      std::any_of(rows.begin(), rows.end(), [](const TermRow* row) { return row->elastic; });
  for (const TermRow* row : rows)
    if (row->acts_on_elastic && !elastic)
      return quoted(row->name) + " acts on elastic terms, but the body has no elastic term";
  for (const TermRow* row : term_rows())
    if (moves && row->moves && row->may_stand_in(domain) && !has(row->role))
      return "a body that moves needs " + listed(of_role(row->role, domain), "or");
  const std::vector<std::string> required = required_roles(domain);
  if (std::all_of(required.begin(), required.end(), has)) return "";
  std::string all;
  for (const std::string& role : required)
    all += (all.empty() ? "" : " and ") + listed(of_role(role, domain), "or");
  return std::string(noun_of(domain)) + " needs " + all;
}

double number_of(const TermRow& row, const std::string& key, const TermData& data) {
  if (const auto said = data.numbers.find(key); said != data.numbers.end()) return said->second;
  for (const TermKey& k : row.keys)
    if (k.name == key && k.fallback) return *k.fallback;
  throw Error::input("term '" + row.name + "' needs the number '" + key + "'");
}

std::vector<std::unique_ptr<Term>> make_terms(std::span<const std::string> names,
                                              const PlaneSection& section,
                                              const std::map<std::string, double>& numbers) {
  TermData data{section, numbers, {}};
  for (const std::string& name : names) data.terms.push_back(&term_row(name));
  std::vector<std::unique_ptr<Term>> out;
  for (const TermRow* row : data.terms) out.push_back(row->make(data));
  return out;
}

std::unique_ptr<Term> make_term(const std::string& name, const PlaneSection& section) {
  return std::move(make_terms(std::span(&name, 1), section, {}).front());
}

std::unique_ptr<Term> make_membrane(const PlaneSection& section) {
  return make_term("membrane", section);
}

std::unique_ptr<Term> make_assumed_membrane(const PlaneSection& section) {
  return make_term("membrane_assumed", section);
}

}  // namespace flexmorph::fem
