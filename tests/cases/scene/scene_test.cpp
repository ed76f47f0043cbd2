// Scenes: both shipped cases load with the numbers of Sun et al. (2018), section 4.2; defaults are
// those of the method; every bad input is refused with one message that says where and why.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <set>

#include "cases/assembly/build.h"
#include "cases/scene/joints/row.h"

namespace flexmorph::cases {
namespace {

using Changes = std::vector<std::string>;

std::string shipped(const std::string& name) {
  return std::string(FLEXMORPH_CASES) + "/" + name + ".toml";
}

Scene read(const std::string& name, const Changes& changes = {}) {
  return read_scene(io::CaseFile(shipped(name), changes));
}

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

class ShippedCase : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedCase, HasTheDataOfThePaper) {
  const bool slow = GetParam() == "rotating_plate_v01";
  const Scene s = read(GetParam());
  EXPECT_EQ(s.name, GetParam());
  EXPECT_EQ(s.time.end, 1);
  EXPECT_EQ(s.time.step, 1e-3);
  EXPECT_EQ(s.time.start, Start::automatic);
  EXPECT_FALSE(s.gravity);
  ASSERT_EQ(s.hubs.size(), 1u);
  EXPECT_EQ(s.hubs[0].angular_velocity, 2 * std::numbers::pi);

  ASSERT_EQ(s.bodies.size(), 1u);
  const Body& plate = s.bodies[0];
  EXPECT_EQ(plate.length, 0.5);
  EXPECT_EQ(plate.width, 0.1);
  EXPECT_EQ(plate.thickness, 0.01);
  EXPECT_EQ(plate.density, 2700);
  EXPECT_EQ(plate.youngs_modulus, 1e8);
  EXPECT_EQ(plate.poisson_ratio, 0.3);
  EXPECT_EQ(plate.elements, (std::array{10, 2}));
  EXPECT_EQ(plate.terms, (std::vector<std::string>{"inertia", "membrane"}));
  ASSERT_TRUE(plate.flow);
  EXPECT_EQ(plate.flow->speed, slow ? 0.1 : 0.5);
  EXPECT_EQ(plate.flow->max_length, 0.1);
  EXPECT_DOUBLE_EQ(plate.flow->min_length, 0.03);
  EXPECT_DOUBLE_EQ(plate.longest(s.time.end), slow ? 0.6 : 1.0);
  EXPECT_EQ(s.point_masses.at(0).mass, 0.5);
  EXPECT_EQ(s.joints.at(0).mode, fem::WeldMode::edge);

  ASSERT_TRUE(s.esl);
  EXPECT_EQ(s.esl->count(s.time.end), slow ? 20 : 100);
  EXPECT_EQ(s.esl->settings.loads, mmc::LoadDefinition::inertia);
  EXPECT_EQ(s.esl->settings.support, mmc::Support::moving_root);
  ASSERT_EQ(s.designs.size(), 1u);
  const BodyDesign& d = s.designs[0];
  EXPECT_EQ(d.grid.nx, slow ? 240 : 400);
  EXPECT_EQ(d.grid.ny, 40);
  EXPECT_EQ(d.grid.y0, -0.05);
  EXPECT_EQ(2 * d.components[0] * d.components[1], slow ? 96 : 160);
  EXPECT_EQ(mmc::allowed_volume(d.goal), 0.5);
  EXPECT_EQ(d.min_thickness, 0.005);
  EXPECT_DOUBLE_EQ(d.tdf.band, d.band.back() * 0.0025);
  EXPECT_DOUBLE_EQ(d.tdf.sharpness, 1500);
  EXPECT_EQ(d.tdf.min_half_thickness, mmc::half_thickness_for(2 * 0.005));
  EXPECT_EQ(d.widths.solid, 2 * 0.005);
  EXPECT_EQ(d.widths.gap, 2 * 0.0025);
  EXPECT_DOUBLE_EQ(d.erosion, (slow ? 0.25 : 0.375) * d.widths.solid);
  // Two columns of cells under the tip mass.
  ASSERT_EQ(d.solid.size(), 1u);
  EXPECT_NEAR(area({d.solid[0], {}}), 0.005 * 0.1, 1e-16);
  EXPECT_EQ(s.optimizer.name, "mma");
  EXPECT_EQ(s.optimizer.max_iterations, 300);
}
INSTANTIATE_TEST_SUITE_P(Cases, ShippedCase,
                         ::testing::Values("rotating_plate_v01", "rotating_plate_v05"));

TEST(SceneReader, OptionalPartsAreAbsentUntilListed) {
  const Scene s = read_scene(io::CaseFile(FLEXMORPH_SHORT_CASE));
  EXPECT_FALSE(s.verify);
  EXPECT_TRUE(s.expect.empty());
  EXPECT_TRUE(s.designs[0].empty.empty());
  const Scene more =
      read("rotating_plate_v01",
           {"gravity=[0, -9.81]", "verify={mesh=[40, 8]}", "time.start=hub_at_rest",
            "optimizer.options.asyinit=0.1", "design.band=[3, 2, 1.5]",
            "expect.compliance={value=2.0, relative=0.1}", "expect.volume={at_most=0.5001}"});
  EXPECT_EQ(*more.gravity, Vec2(0, -9.81));
  EXPECT_EQ(more.verify->mesh, (std::array{40, 8}));
  EXPECT_EQ(more.verify->step, more.time.step);
  EXPECT_DOUBLE_EQ(more.time.spin_up, 0.2);
  EXPECT_EQ(more.optimizer.options.at("asyinit"), 0.1);
  EXPECT_EQ(more.optimizer.rest.rows, 15);
  EXPECT_DOUBLE_EQ(more.designs[0].at_band(0).band, 3 * 0.0025);
  EXPECT_DOUBLE_EQ(more.designs[0].tdf.band, 1.5 * 0.0025);
  EXPECT_TRUE(more.expect.at("compliance").holds(1.81));
  EXPECT_FALSE(more.expect.at("compliance").holds(1.79));
  EXPECT_FALSE(more.expect.at("compliance").holds(std::nan("")));
  EXPECT_TRUE(more.expect.at("volume").holds(0.5));
  EXPECT_FALSE(more.expect.at("volume").holds(0.51));
}

// The initial components fill about the allowed volume when nothing else is said.
TEST(SceneReader, DefaultComponentsFillTheVolume) {
  std::string text;
  {
    std::ifstream in(shipped("rotating_plate_v01"));
    for (std::string line; std::getline(in, line);)
      if (!line.starts_with("half_length")) text += line + "\n";
  }
  const std::string path = ::testing::TempDir() + "flexmorph_default_components.toml";
  std::ofstream(path) << text;
  const Scene s = read_scene(io::CaseFile(path, Changes{"design.min_thickness=1e-4"}));
  std::remove(path.c_str());
  const BodyDesign& d = s.designs[0];
  const double box = 0.025 * 0.05;
  EXPECT_DOUBLE_EQ(d.half_length, 0.5 * std::hypot(0.025, 0.05));
  // Two bars of 2 L x 2 c in every box; where they cross is counted twice.
  EXPECT_NEAR(2 * 4 * d.half_length * d.half_thickness / box, 0.5, 1e-12);
}

/// Names of rows, each with a sentence.
template <class Rows>
std::set<std::string> described(const Rows& rows) {
  std::set<std::string> names;
  for (const auto* row : rows) {
    EXPECT_TRUE(names.insert(row->name).second) << row->name << " twice";
    EXPECT_TRUE(std::string(row->sentence).ends_with(".")) << row->name;
  }
  return names;
}

TEST(SceneReader, KnowsTheRowsOfItsTablesAndNoOthers) {
  EXPECT_EQ(described(spring_rows()), (std::set<std::string>{"linear", "torsion", "bushing", "stop",
                                                             "distance_stop", "angle_stop"}));
  EXPECT_EQ(described(load_rows()).size(), 7u);
  const std::string message = complaint({"joint.type=hinge"});
  for (const std::string& name : described(joint_rows()))
    EXPECT_NE(message.find("'" + name + "'"), std::string::npos) << name;
  const std::string terms = complaint({"body.terms=[\"hinge\"]"});
  const auto known = described(fem::term_rows());
  for (const std::string& name : fem::term_names(fem::TermPlace::plane)) {
    EXPECT_NE(terms.find("'" + name + "'"), std::string::npos) << name;
    EXPECT_TRUE(known.contains(name));
  }
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

// In the file itself the message names the line, the key and the value.
TEST(SceneReader, ErrorsInTheFileNameLineKeyAndValue) {
  std::string text;
  int line = 0, found = 0;
  {
    std::ifstream in(shipped("rotating_plate_v05"));
    for (std::string each; std::getline(in, each);) {
      ++line;
      if (each.starts_with("thickness")) each = "thickness = -0.002", found = line;
      text += each + "\n";
    }
  }
  const std::string path = ::testing::TempDir() + "flexmorph_negative_thickness.toml";
  std::ofstream(path) << text;
  std::string message;
  try {
    read_scene(io::CaseFile(path));
  } catch (const Error& e) {
    message = e.what();
  }
  std::remove(path.c_str());
  EXPECT_EQ(message, path + ":" + std::to_string(found) +
                         ":13: body.thickness = -0.002: a thickness is positive [m]");
}

// Cells of a motion with a gradient are so many of the designs' cells each way, squares or not.
TEST(SceneReader, MergesAsManyCellsOfAllDesigns) {
  EXPECT_EQ(read("motion_platform", {"cycle.correct=first_order", "cycle.cell=0.00501"}).cycle.cell,
            0.00501);
  const Changes changes = {"cycle.cell=0.0166667", "cycle.correct=first_order",
                           "design.1.cells=[30, 12]"};
  std::string message;
  try {
    read_scene(io::CaseFile(FLEXMORPH_TWO_PLATES, changes));
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_TRUE(message.ends_with("as many cells of 'light' (0.0166667 m) as of the other designs"))
      << message;
}

// Another body's lines that find their own way: when its mesh changes depends on the design.
TEST(SceneReader, RefusesGradientsWhereLinesAreFree) {
  std::string text;
  {
    std::ifstream in(FLEXMORPH_TWO_PLATES);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  const std::string elements = "elements = [6, 1]";
  text.replace(text.rfind(elements), elements.size(),
               "elements = [6, 1]\n[[body.line]]\nindex = 3\nfree = true\nat = 0.25");
  const size_t weld = text.rfind("type = \"weld\"");
  text.replace(weld, text.find("[[point_mass]]") - weld,
               "type = \"sleeve\"\nbody = \"light\"\nedge = \"line 3\"\n"
               "mode = \"direction\"\nposition = [2.25, 0.0]\n\n");
  const size_t second = text.rfind("[[design]]"), after = text.find("[optimizer]");
  text.erase(second, after - second);
  const std::string path = ::testing::TempDir() + "flexmorph_free_line.toml";
  std::ofstream(path) << text;
  for (const char* change : {"cycle.correct=first_order", "certificate.checkpoints=0"}) {
    std::string message;
    try {
      const Changes changes = {change, "design.0.coupling=none", "time.start=rigid"};
      read_scene(io::CaseFile(path, changes));
    } catch (const Error& error) {
      message = error.what();
      EXPECT_EQ(error.kind(), Error::Kind::input);
    }
    EXPECT_TRUE(
        message.ends_with("there is no exact gradient: when meshes with free lines change "
                          "depends on the design ([[body.line]])"))
        << message;
  }
  std::remove(path.c_str());
}

// Designs that share mass minimize sums of compliances, all of them; volumes may differ.
TEST(SceneReader, OnlyDesignsWithTheSameGoalShareMass) {
  std::string text;
  {
    std::ifstream in(FLEXMORPH_TWO_PLATES);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  const auto complaint_of = [&](const Changes& changes, bool volume) -> std::string {
    std::string changed = text;
    const std::string goal = "max_volume = 0.5";
    if (volume)
      changed.replace(changed.rfind(goal), goal.size(),
                      "minimize = \"volume\"\nmax_compliance = 1.0");
    const std::string path = ::testing::TempDir() + "flexmorph_two_plates.toml";
    std::ofstream(path) << changed;
    std::string message;
    try {
      const Scene scene = read_scene(io::CaseFile(path, changes));
      EXPECT_TRUE(scene.designs[0].shares_mass && scene.designs[1].shares_mass);
    } catch (const Error& e) {
      message = e.what();
    }
    std::remove(path.c_str());
    return message;
  };
  EXPECT_EQ(complaint_of({"design.light.max_volume=0.3"}, false), "");
  EXPECT_TRUE(complaint_of({"design.light.loads=worst"}, false)
                  .ends_with("only with loads = \"sum\": compliances of all bodies are added"));
  EXPECT_TRUE(complaint_of({}, true).ends_with(
      "only with minimize = \"compliance\": what is shared is what max_volume allows"));
  EXPECT_TRUE(complaint_of({"design.light.coupling=none"}, false)
                  .ends_with("no other [[design]] has \"shared_mass\" to share with"));
}

}  // namespace
}  // namespace flexmorph::cases
