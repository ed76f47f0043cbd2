#include "cases/scene/accuracy.h"

#include "io/files.h"

namespace flexmorph::cases {
namespace {

using io::any_number;
using io::Key;
using io::positive;
using io::Table;

/// Returns the numbers that had another name in the last version.
io::Glossary former_quantities() {
  return {{"sharp_compliance", "crisp_compliance"},
          {"sharp_volume", "crisp_volume"},
          {"energy.error", "energy.error"},
          {"motion.energy_defect", "motion.energy_error"}};
}

const Key& kQuantity =
    io::key("accuracy", "quantity")
        .renames(former_quantities())
        .text("a quantity of interest")
        .texts("a quantity of interest")
        .tables_of()
        .description("Quantity of interest: table column, or number of a design or of run.json.");
const Key& kName =
    io::key("accuracy.quantity", "name")
        .renames(former_quantities())
        .text("a quantity of interest")
        .description(
            "Name of a quantity of interest that gets a separate time, scale or reference.");
const Key& kRefinements =
    io::key("accuracy", "refinements")
        .formerly("ladders")
        .texts("a refinement series")
        .otherwise_as("all that apply")
        .description("Discretization parameters that are refined, one after the other.");
const io::Choice<bool> kDesign(
    io::key("accuracy", "design")
        .otherwise("start")
        .description(
            "Designs of the study: the initial ones (`start`) or the final ones (`optimized`)."),
    "a design", {{"start", false}, {"optimized", true}});

// Keys of [accuracy], which apply to all quantities, and of one [[accuracy.quantity]].
const io::Choice<Interest::At> kAt(
    io::shared_key({"accuracy", "accuracy.quantity"}, "at")
        .number(io::not_negative("a time", "s"))
        .otherwise_as("`end`")
        .description("Time at which a column is evaluated; `max` is its largest absolute value."),
    "a time in words", {{"end", Interest::At::end}, {"max", Interest::At::max}});
const Key& kScale = io::shared_key({"accuracy", "accuracy.quantity"}, "scale")
                        .number(positive("a scale of errors"))
                        .otherwise_as("the value itself")
                        .description("Scale of relative errors, in the unit of the quantity.");
const Key& kReference =
    io::shared_key({"accuracy", "accuracy.quantity"}, "reference")
        .table()
        .otherwise_as("none")
        .description("Reference value of the quantity of interest, from another source.");
constexpr const char* kInAll = "accuracy.reference";
constexpr const char* kInOne = "accuracy.quantity.reference";
const Key& kValue = io::shared_key({kInAll, kInOne}, "value")
                        .number(any_number("a reference"))
                        .otherwise_as("required unless `file` is given")
                        .description("Reference value of the quantity.");
const Key& kFile = io::shared_key({kInAll, kInOne}, "file")
                       .text("a CSV file")
                       .otherwise_as("required unless `value` is given")
                       .description(
                           "CSV file beside the case file; its column with the name of the "
                           "quantity is the reference.");
const Key& kSource = io::shared_key({kInAll, kInOne}, "source")
                         .text("the source of a reference")
                         .description("Source of the reference, such as a publication.");

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
    reference.fail("a reference needs either a `value` or a `file`");
  if (reference.has(kValue))
    interest.value = reference.number(kValue);
  else
    interest.file = reference.path_of(kFile);
  interest.source = reference.string(kSource);
}

void add(Accuracy& out, const Table& t, const Key& key, const Interest& interest) {
  if (interest.name.empty()) t.fail(key, "the name of a quantity is not empty");
  for (const Interest& other : out.quantities)
    if (other.words() == interest.words()) t.fail(key, "this quantity is listed a second time");
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
  out.location = t.location();
  if (t.has(kRefinements)) out.refinements = t.strings(kRefinements);
  out.optimized = t.choice(kDesign);
  Interest shared;
  read_shared(t, shared);
  if (t.is_string(kQuantity)) {
    shared.name = t.string(kQuantity);
    add(out, t, kQuantity, shared);
  } else if (t.is_list_of_strings(kQuantity)) {
    if (shared.has_reference())
      t.fail(kReference, "several quantities need separate references: use [[accuracy.quantity]]");
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
    t.fail(
        "the table [accuracy] needs a `quantity`: a name, a list of names, or "
        "[[accuracy.quantity]]");
  return out;
}

}  // namespace flexmorph::cases
