#include "cases/run/motion_run_memory.h"

namespace flexmorph {

namespace fem {

void remember(Memory& memory, NodalForce& f) { memory(f.node, f.force); }

void remember(Memory& memory, EslSet& s) {
  memory(s.time, s.weight, s.root_column, s.deformation, s.acceleration, s.forces, s.strain_energy,
         s.thermal_stretch, s.held_stretch, s.held_end_stretch);
}

void remember(Memory& memory, EslSets& loads) { memory(loads.sets, loads.strain_energy_integral); }

}  // namespace fem

namespace io {

void remember(Memory& memory, PlanePlate& p) { memory(p.n_across, p.points, p.density); }
void remember(Memory& memory, PlaneFrame& f) { memory(f.title, f.plates, f.outlines); }

}  // namespace io

namespace cases {

void remember(Memory& memory, MotionRecord& r) {
  memory(r.bodies, r.growing, r.time, r.kinetic, r.strain, r.potential, r.defect, r.deflection,
         r.amplitude, r.strain_integral, r.observed, r.written, r.powers, r.moments, r.remarks);
}

}  // namespace cases

}  // namespace flexmorph
