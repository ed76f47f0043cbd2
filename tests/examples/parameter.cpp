#include "cases/accuracy/parameters.h"
#include "io/case_files/case_file.h"
#include "io/files.h"

/// Complete example of a parameter of `flexmorph accuracy`: the time in which hubs reach their
/// angular velocity.
namespace flexmorph::cases {
namespace {

std::string absent(const Scene& scene, Part part) {
  return part == Part::motion && scene.time.start == Start::hub_at_rest ? "" : "no hub spins up";
}

std::vector<Level> levels(const Scene& scene, const io::CaseFile&) {
  std::vector<Level> out;
  for (const double factor : {0.5, 1.0, 2.0, 4.0}) {
    const std::string spin_up = io::to_text(factor * scene.time.spin_up);
    out.push_back({1 / factor, spin_up + " s", {"time.spin_up=" + spin_up}});
    if (factor == 1) out.back().overrides.clear();
  }
  return out;
}

std::optional<Theory> theory(const Scene&, Part, const std::string&) { return {}; }

}  // namespace

extern const Parameter kSpinUp;
const Parameter kSpinUp{"spin_up", "spin_up", Approach::power, 0, true, absent, levels, theory};

}  // namespace flexmorph::cases
