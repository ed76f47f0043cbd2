#include "cases/scene/accuracy.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::Key;
using io::positive;
using io::Table;

const Key& kQuantity =
    io::key("accuracy", "quantity")
        .text("a quantity of interest")
        .texts("a quantity of interest")
        .tables_of()
        .says("A column of motion.csv or path.csv, a figure of the design, a number of run.json.");
const Key& kName = io::key("accuracy.quantity", "name")
                       .text("a quantity of interest")
                       .says("Likewise, of one that has its own time, scale or reference.");
const Key& kLadders = io::key("accuracy", "ladders")
                          .texts("a ladder")
                          .otherwise_as("all that apply")
                          .says("The parameters that are refined, one after the other.");
const io::Choice<bool> kDesign(
    io::key("accuracy", "design").otherwise("start").says("Designs as they start, or as they end."),
    "a design", {{"start", false}, {"optimized", true}});

// Keys of [accuracy], which apply to all quantities, and of one [[accuracy.quantity]].
const io::Choice<Interest::At> kAt(
    io::shared_key({"accuracy", "accuracy.quantity"}, "at")
        .number(io::not_negative("a time", "s"))
        .otherwise_as("`end`")
        .says("When a column is looked at; `max`: its largest size."),
    "a time in words", {{"end", Interest::At::end}, {"max", Interest::At::max}});
const Key& kScale = io::shared_key({"accuracy", "accuracy.quantity"}, "scale")
                        .number(positive("a scale of errors"))
                        .otherwise_as("the value itself")
                        .says("Errors are parts of it.");
const Key& kReference = io::shared_key({"accuracy", "accuracy.quantity"}, "reference")
                            .table()
                            .otherwise_as("none")
                            .says("What is known from elsewhere.");
constexpr const char* kInAll = "accuracy.reference";
constexpr const char* kInOne = "accuracy.quantity.reference";
const Key& kValue = io::shared_key({kInAll, kInOne}, "value")
                        .number(any_number("a reference"))
                        .otherwise_as("`file` is given")
                        .says("The number.");
const Key& kFile = io::shared_key({kInAll, kInOne}, "file")
                       .text("a CSV file")
                       .otherwise_as("`value` is given")
                       .says("Or a table beside the case, with a column of this name.");
const Key& kSource = io::shared_key({kInAll, kInOne}, "source")
                         .text("where the reference comes from")
                         .says("Where it comes from.");

/// Reads the keys that stand in [accuracy] for all quantities, or in one [[accuracy.quantity]].
void read_shared(const Table& t, Interest& interest) {
  if (t.is_string(kAt)) {
    interest.at = t.choice(kAt);
  } else if (t.has(kAt)) {
    interest.at = Interest::At::time;
    interest.time = t.number(kAt);
  }
  if (t.has(kScale)) interest.scale = t.number(kScale);
  if (!t.has(kReference)) return;
  const Table reference = t.table(kReference);
  if (reference.has(kValue) == reference.has(kFile))
    reference.fail("a reference has either a `value` or a `file`");
  if (reference.has(kValue))
    interest.value = reference.number(kValue);
  else
    interest.file = reference.path_of(kFile);
  interest.source = reference.string(kSource);
}

void add(Accuracy& out, const Table& t, const Key& key, const Interest& interest) {
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

std::vector<std::string> overrides_of_reference_files(const Table& t) {
  std::vector<std::string> out;
  const auto keep = [&](const Table& of, const std::string& path) {
    if (!of.has(kReference)) return;
    const Table reference = of.table(kReference);
    if (reference.is_string(kFile))
      out.push_back(path + ".reference.file='" + reference.absolute(kFile) + "'");
  };
  keep(t, "accuracy");
  if (t.is_string(kQuantity) || t.is_list_of_strings(kQuantity)) return out;
  const std::vector<Table> each = t.tables(kQuantity);
  for (size_t i = 0; i < each.size(); ++i) keep(each[i], "accuracy.quantity." + std::to_string(i));
  return out;
}

Accuracy read_accuracy(const Table& t) {
  Accuracy out;
  out.place = t.place();
  if (t.has(kLadders)) out.ladders = t.strings(kLadders);
  out.optimized = t.choice(kDesign);
  Interest shared;
  read_shared(t, shared);
  if (t.is_string(kQuantity)) {
    shared.name = t.string(kQuantity);
    add(out, t, kQuantity, shared);
  } else if (t.is_list_of_strings(kQuantity)) {
    if (shared.has_reference())
      t.fail(kReference, "several quantities have references of their own: [[accuracy.quantity]]");
    for (const std::string& name : t.strings(kQuantity)) {
      shared.name = name;
      add(out, t, kQuantity, shared);
    }
  } else {
    for (const Table& each : t.tables(kQuantity)) {
      Interest own = shared;
      own.name = each.string(kName);
      read_shared(each, own);
      add(out, each, kName, own);
    }
  }
  if (out.quantities.empty())
    t.fail("an [accuracy] has a `quantity`: a name, a list of names, or [[accuracy.quantity]]");
  return out;
}

}  // namespace flexmorph::cases
