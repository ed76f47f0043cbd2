#include "cases/scene/accuracy.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::positive;
using io::Table;

/// Keys that several quantities may share, or each have for itself.
void read_shared(const Table& t, Interest& interest) {
  if (t.is_string("at")) {
    interest.at = t.choice<Interest::At>("at", "a time in words",
                                         {{"end", Interest::At::end}, {"max", Interest::At::max}});
  } else if (t.has("at")) {
    interest.at = Interest::At::time;
    interest.time = t.number("at", io::not_negative("a time", "s"));
  }
  if (t.has("scale")) interest.scale = t.number("scale", positive("a scale of errors"));
  if (!t.has("reference")) return;
  const Table reference = t.table("reference");
  if (reference.has("value") == reference.has("file"))
    reference.fail("a reference has either a `value` or a `file`");
  if (reference.has("value"))
    interest.value = reference.number("value", any_number("a reference"));
  else
    interest.file = reference.beside(reference.string("file", "a CSV file"));
  interest.source = reference.string("source", "where the reference comes from");
}

void add(Accuracy& out, const Table& t, const std::string& key, const Interest& interest) {
  if (interest.name.empty()) t.fail(key, "a quantity has a name");
  for (const Interest& other : out.quantities)
    if (other.words() == interest.words()) t.fail(key, "the same quantity twice");
  out.quantities.push_back(interest);
}

}  // namespace

std::string Interest::words() const {
  if (at == At::max) return name + ", largest";
  if (at == At::time) return name + " at " + io::to_text(time);
  return name;
}

Accuracy read_accuracy(const Table& t) {
  Accuracy out;
  out.place = t.place();
  if (t.has("ladders")) out.ladders = t.strings("ladders", "a ladder");
  out.optimized =
      t.choice<bool>("design", "a design", {{"start", false}, {"optimized", true}}, false);
  Interest shared;
  read_shared(t, shared);
  if (t.is_string("quantity")) {
    shared.name = t.string("quantity", "a quantity of interest");
    add(out, t, "quantity", shared);
  } else if (t.is_list_of_strings("quantity")) {
    if (shared.has_reference())
      t.fail("reference", "several quantities have references of their own: [[accuracy.quantity]]");
    for (const std::string& name : t.strings("quantity", "a quantity of interest")) {
      shared.name = name;
      add(out, t, "quantity", shared);
    }
  } else {
    for (const Table& each : t.tables("quantity")) {
      Interest own = shared;
      own.name = each.string("name", "a quantity of interest");
      read_shared(each, own);
      add(out, each, "name", own);
    }
  }
  if (out.quantities.empty())
    t.fail("an [accuracy] has a `quantity`: a name, a list of names, or [[accuracy.quantity]]");
  return out;
}

}  // namespace flexmorph::cases
