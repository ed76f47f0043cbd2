// Cases that are refused: one message each, with the place.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cases/scenes.h"

namespace flexmorph::cases {
namespace {

/// What is said about rotating_plate_v01 with these changes; empty when it is accepted.
std::string complaint(const Changes& changes) {
  try {
    read("rotating_plate_v01", changes);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), Error::Kind::input);
    return e.what();
  }
  return "";
}

struct Bad {
  const char* what;
  Changes changes;
  std::string message;  ///< its end
};
void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.what; }

class BadInput : public ::testing::TestWithParam<Bad> {};

TEST_P(BadInput, IsRefusedWithOneLocatedMessage) {
  const std::string message = complaint(GetParam().changes);
  ASSERT_FALSE(message.empty()) << GetParam().changes[0];
  const std::string option = "--set " + GetParam().changes[0] + ": ";
  const std::string file = shipped("rotating_plate_v01") + ":";
  EXPECT_TRUE(message.starts_with(option) || message.starts_with(file)) << message;
  EXPECT_TRUE(message.ends_with(GetParam().message)) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

const Bad kBadInputs[] = {
    {"unknown_key", {"body.thicknes=1"}, "unknown key, did you mean 'thickness'?"},
    {"unknown_table",
     {"optimiser.name=mma"},
     "[optimiser]: unknown key, did you mean 'optimizer'?"},
    {"wrong_type",
     {"body.width=\"wide\""},
     "a width is positive [m]; a number stands without quotes"},
    {"negative_thickness", {"body.thickness=-0.002"}, "a thickness is positive [m]"},
    {"correction_of_adaptive_steps",
     {"cycle.correct=first_order", "time.step=adaptive"},
     "there is no exact gradient: steps that adapt depend on the design (time.tolerance)"},
    {"correction_of_another_integrator",
     {"cycle.correct=direct", "time.integrator=energy_momentum", "verify="},
     "there is no exact gradient: \"energy_momentum\" has none, \"generalized_alpha\" does "
     "(time.integrator)"},
    {"correction_on_cells_between",
     {"cycle.cell=0.004", "cycle.correct=first_order"},
     "a whole number of cells of 'plate' (0.0025 m), which divides its length and its width"},
    {"sum_of_loads_and_motion",
     {"design.objective=[{response=\"deflection\"}]", "cycle.correct=direct"},
     "only numbers of the motion have sums: `minimize` is the summed compliance"},
    {"sum_of_motion_and_mass",
     {"design.objective=[{response=\"mass\"}]", "design.minimize=deflection",
      "cycle.correct=direct"},
     "a number of the motion"},
    {"sum_of_one_number_twice",
     {"design.objective=[{response=\"deflection\"}]", "design.minimize=deflection",
      "cycle.correct=direct"},
     "each number once"},
    {"weight_of_nothing",
     {"design.objective=[{response=\"deflection\", weight=0}]", "design.minimize=strain_energy",
      "cycle.correct=direct"},
     "a weight is positive"},
    {"limit_of_an_addend",
     {"design.constraint=[{response=\"deflection\", at_most=0.1}]",
      "design.objective=[{response=\"deflection\"}]", "design.minimize=strain_energy",
      "cycle.correct=direct"},
     "what is minimized has no limit"},
    {"motion_without_correction",
     {"cycle.correct=none", "design.minimize=deflection"},
     "[[design]] 'plate' asks for numbers of the motion: \"first_order\" or \"direct\""},
    {"trajectory_without_one",
     {"cycle.correct=direct", "design.minimize=trajectory_error"},
     "\"trajectory_error\" needs a [trajectory]"},
    {"correction_settings_without_it", {"cycle.radius=0.1"}, "without `correct` this does nothing"},
    {"no_volume", {"design.max_volume=0"}, "a volume fraction lies between 0 and 1 (0 excluded)"},
    {"c_min_above_width",
     {"design.min_thickness=0.2"},
     "a smallest half-thickness fits into the width: it lies between 0 and 0.05 (0 excluded) [m]"},
    {"no_components",
     {"design.components=[0, 2]"},
     "a list of 2: a number of boxes of two components is a whole number between 1 and 100000"},
    {"empty_components",
     {"design.components=[]"},
     "a list of 2: a number of boxes of two components is a whole number between 1 and 100000"},
    {"end_zero", {"time.end=0"}, "an end time is positive [s]"},
    {"ten_million_cells",
     {"design.cell=7.75e-5"},
     "9.99e+06 cells; at most 4e+06, so a cell of at least 0.000123 [m]"},
    {"uneven_cells",
     {"design.cell=0.003"},
     "a cell divides the longest length 0.6 and the width 0.1 of 'plate' [m]"},
    {"root_between_lines",
     {"esl.every=0.03"},
     "the root of 'plate' moves by 1.2 cells between loads; a whole number is needed, so a "
     "multiple of 0.025 [s]"},
    {"late_loads", {"esl.every=2"}, "the first load is no later than time.end [s]"},
    {"unknown_hub", {"joint.to=hob"}, "a hub is 'hub', did you mean 'hub'?"},
    {"unknown_body", {"point_mass.body=arm"}, "a body is 'plate'"},
    {"unknown_element",
     {"body.element=shell"},
     "an element is one of 'ancf_plate', 'ale_ancf_plate', 'ancf_beam'"},
    {"unknown_term",
     {"body.terms=[\"inertia\", \"bending\"]"},
     "a list: a term is one of 'inertia', 'membrane', 'membrane_assumed', 'damping', none twice"},
    {"unknown_optimizer",
     {"optimizer.name=sqp"},
     "an optimizer is one of 'gcmma', 'ipopt', 'mma', 'nlopt_ccsaq', 'nlopt_mma'"},
    {"unknown_start",
     {"time.start=rigit"},
     "a start is one of 'automatic', 'prestretched', 'steady', 'rigid', 'hub_at_rest', did you "
     "mean 'rigid'?"},
    {"spin_up_of_another_start", {"time.spin_up=0.1"}, "only start = \"hub_at_rest\" spins up"},
    {"rho_inf", {"time.rho_inf=1.1"}, "a spectral radius lies between 0 and 1"},
    {"long_step", {"time.step=2"}, "a time step is no longer than time.end [s]"},
    {"unknown_step", {"time.step=adaptiv"}, "did you mean 'adaptive'?"},
    {"tolerance_of_equal_steps",
     {"time.tolerance=1e-3"},
     "only step = \"adaptive\" and \"minimal_coordinates\" have one"},
    {"wide_tolerance",
     {"time.tolerance=0.5", "time.step=adaptive"},
     "a tolerance lies between 0 and 0.1 (0 excluded)"},
    {"long_largest_step",
     {"time.largest_step=2", "time.step=adaptive"},
     "a time step is no longer than time.end [s]"},
    {"adaptive_energy_momentum",
     {"time.step=adaptive", "time.integrator=energy_momentum"},
     "only \"generalized_alpha\" knows its local error, which \"adaptive\" needs"},
    {"chatter",
     {"body.flow.min_length=0.05"},
     "min_length + the neighbour's 0.05 m stays below 0.9 max_length, or elements are split and "
     "merged in turn"},
    {"elements_too_long",
     {"body.elements=[4, 2]"},
     "the elements are 0.125 m long at the start: more elements, or a larger max_length [m]"},
    {"elements_too_short",
     {"body.elements=[40, 8]"},
     "the elements are 0.0125 m long at the start, shorter than min_length = 0.03 m, and would be "
     "merged at once"},
    {"flow_without_ale",
     {"body.element=ancf_plate"},
     "[body.flow]: material flows through \"ale_ancf_plate\" only"},
    {"no_strip",
     {"design.solid=[]"},
     "the point mass at the free end of 'plate' needs solid material: [[design.solid]] with strip "
     "= \"free_end\", cells = 2"},
    {"thin_strip",
     {"design.solid.cells=1"},
     "the point mass at the free end of 'plate' needs solid material: [[design.solid]] with strip "
     "= \"free_end\", cells = 2"},
    {"solid_and_void",
     {"design.void=[{box=[0.5, -0.05, 0.6, 0.05]}]"},
     "a region cannot be solid and void at once"},
    {"box_outside",
     {"design.void=[{box=[1, 1, 2, 2]}]"},
     "a box holds the centre of a cell; the domain is [0, 0.6] x [-0.05, 0.05] [m]"},
    {"no_room", {"design.max_volume=0.008"}, "the solid regions alone fill 0.00833 of the domain"},
    {"coarser_bands", {"design.band=[1, 2]"}, "bands go from coarse to fine"},
    {"far_end_inertia",
     {"esl.support=far_end"},
     "\"inertia\" loads need \"moving_root\": at the far end the reactions of the root would have "
     "to follow the design"},
    {"load_a_design_does_not_know",
     {"load=[{type='surface', body='plate', force=[0, 1]}]"},
     "a designed body is loaded at points or along its \"free_end\", not by \"surface\""},
    {"load_off_the_design_mesh",
     {"load=[{type='point', body='plate', point=[0.6, 0.0011], force=[0, 1]}]"},
     "a force on a designed body acts at a node of its design mesh"},
    {"two_verifications", {"verify.refine=2"}, "a finer run has a `mesh`, `refine` or `cells`"},
    {"mesh_and_cells", {"verify.mesh=[20, 4]"}, "a finer run has a `mesh`, `refine` or `cells`"},
    {"cells_without_a_gradient",
     {"verify={cells=1}", "time.integrator=\"energy_momentum\""},
     "void on cells has no discrete gradient for \"energy_momentum\""},
    {"moving_cells_without_a_gradient",
     {"time.integrator=\"energy_momentum\"", "body.shape=\"q4\"", "body.flow.max_length="},
     "void on cells has no discrete gradient for \"energy_momentum\""},
    {"cells_with_limits",
     {"body.shape=\"q4\""},
     "cells (shape \"q4\") have no limits of their own"},
    {"cells_in_space",
     {"body.shape=\"q4\"", "body.space=\"space\""},
     "cells (\"q4\") live in the plane: they cannot bend out of it"},
    {"assumed_strains_of_cells",
     {"body.terms=[\"inertia\", \"membrane_assumed\"]", "body.shape=\"q4\""},
     "\"membrane_assumed\" does not know cells (shape \"q4\")"},
    {"coarse_verification", {"verify={mesh=[5, 2]}"}, "a finer mesh than the elements of 'plate'"},
    {"body_named_energy", {"body.name=energy"}, "'energy' names columns of motion.csv already"},
    {"body_named_hub", {"body.name=hub"}, "there is another 'hub'"},
    {"body_with_a_blank",
     {"body.name=\"a b\""},
     "the name of a body begins with a letter; letters, digits and _ follow, 64 at most in all"},
    {"no_body", {"body=[]"}, "a scene has one or more [[body]]"},
    {"free_root",
     {"joint=[]"},
     "material flows out of a hub: a [[joint]] with edge = \"root\" is missing"},
    {"design_without_loads", {"esl=1"}, "[esl] is a table"},
    {"nothing_to_design", {"design=[]"}, "optimizer: without a [[design]] this does nothing"},
    {"nobody_to_share_with",
     {"design.coupling=shared_mass"},
     "no other [[design]] has \"shared_mass\" to share with"},
    {"unknown_coupling", {"design.coupling=shared"}, "a coupling is one of 'none', 'shared_mass'"},
    {"two_tolerances",
     {"expect.c={value=1, relative=1, absolute=1}"},
     "expect.c: a value comes with one tolerance, `relative` or `absolute`"},
    {"option_nobody_knows",
     {"optimizer.options.boxes=0.1", "optimizer.name=ipopt"},
     "optimizer 'ipopt': option 'boxes' is not known; there are: bound_push, box, exact, history, "
     "mu_init, restart"},
    {"widths_of_the_papers_tdf",
     {"design.min_feature=0.01", "design.tdf=paper"},
     "`tdf = \"paper\"` is no distance, and has no widths: 0"},
    {"option_out_of_its_range",
     {"optimizer.options.asydecr=1.5"},
     "optimizer 'mma': option 'asydecr' = 1.5: it lies between 0.01 and 1"},
    {"option_of_an_optimizer",
     {"optimizer.options.asyinit=fast"},
     "an option is a finite number; a number stands without quotes"},
};
INSTANTIATE_TEST_SUITE_P(Inputs, BadInput, ::testing::ValuesIn(kBadInputs),
                         [](const auto& test) { return std::string(test.param.what); });

}  // namespace
}  // namespace flexmorph::cases
