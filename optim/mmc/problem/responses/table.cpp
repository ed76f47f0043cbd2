#include <algorithm>

#include "geometry/registry.h"
#include "optim/mmc/problem/responses/rows.h"

namespace flexmorph::mmc {

extern const ResponseRow kInertia, kDeflection, kTrajectoryError, kJointForce;

namespace {

Registry<ResponseRow>& registry() {
  static Registry<ResponseRow> all(
      "response", key_of,
      {&kComplianceSum, &kComplianceWorst, &kVolume, &kMass, &kInertia, &kStrainEnergy,
       &kPeakStrainEnergy, &kDeflection, &kTrajectoryError, &kJointForce});
  return all;
}

}  // namespace

std::span<const ResponseRow* const> responses() { return registry().rows(); }
void register_response(const ResponseRow& row) {
  if (!row.make) throw Error::input("response '" + key_of(row) + "' has no make()");
  registry().add(row);
}

const ResponseRow* find_response(std::string_view name, std::string_view loads) {
  const auto rows = responses();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const ResponseRow* row) {
    return row->name == name && (row->loads.empty() || row->loads == loads);
  });
  return found == rows.end() ? nullptr : *found;
}

std::string key_of(const ResponseRow& row) {
  std::string out(row.name);
  return row.loads.empty() ? out : out.append("_").append(row.loads);
}

}  // namespace flexmorph::mmc
