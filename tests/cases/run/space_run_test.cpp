// Shows that shortened runs of the shipped spatial cases write their folders and agree with
// independent numbers.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/cases/run_json.h"

namespace flexmorph::test {
namespace {

namespace fs = std::filesystem;

size_t frames(const std::string& folder) {
  const std::string index = contents_of(folder + "/motion/motion.pvd");
  size_t n = 0;
  for (size_t at = index.find("<DataSet "); at != std::string::npos;
       at = index.find("<DataSet ", at + 1))
    ++n;
  return n;
}

const Words kEnergies = {"energy.kinetic", "energy.strain", "energy.potential", "energy.error"};

Words columns(Words first) {
  first.insert(first.end(), kEnergies.begin(), kEnergies.end());
  return first;
}

// Reference: Exudyn with 8 x 8 elements has x = y = 0.30000, z = -0.049049 m at 0.1 s; a corner in
// free fall would have z = -0.04905 m.
TEST(SpaceRun, PendulumFallsAsThePublicCodeSays) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, "plate_pendulum", folder, {"time.end=0.1"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable motion = io::read_csv(folder + "/motion.csv");
  EXPECT_EQ(motion.columns,
            columns({"time", "plate.corner_x", "plate.corner_y", "plate.corner_z"}));
  ASSERT_EQ(motion.n_rows(), 101u);
  EXPECT_NEAR(motion.numbers("plate.corner_z").back(), -0.049049, 1e-5);
  EXPECT_NEAR(motion.numbers("plate.corner_x").back(), 0.3, 1e-5);
  EXPECT_NEAR(motion.numbers("plate.corner_y").back(), 0.3, 1e-5);
  EXPECT_EQ(frames(folder), 11u);
  for (const char* name :
       {"plots/observed.svg", "plots/energies.svg", "plots/shapes.svg", "report.html"})
    EXPECT_TRUE(fs::is_regular_file(folder + "/" + name)) << name;
  // there is no hub that a deflection could refer to
  EXPECT_FALSE(fs::exists(folder + "/plots/deflection.svg"));
  const std::string frame = contents_of(folder + "/motion/motion_plate_00011.vtu");
  EXPECT_TRUE(contains(frame, "NumberOfPoints=\"1089\" NumberOfCells=\"1024\""));
  for (const char* name :
       {"displacement", "motion", "strain_energy_per_area", "von_mises", "J/m^2"})
    EXPECT_TRUE(contains(frame, name)) << name;
}

TEST(SpaceRun, EnergyMomentumKeepsThePendulumsEnergy) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, "plate_pendulum", folder,
          {"time.end=0.05", "body.elements=[4, 4]", "time.integrator=energy_momentum"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable motion = io::read_csv(folder + "/motion.csv");
  const double exchanged = motion.numbers("energy.kinetic").back();
  EXPECT_GT(exchanged, 0.1);
  for (const double energy_error : motion.numbers("energy.error"))
    EXPECT_LT(std::abs(energy_error), 1e-11 * exchanged);
}

// An end moment M = 2π EI/L bends a strip to a circle. The curvature κ = r_mm · n/|n|³ depends on
// the stretches s along and w across the strip: the energy per length is U = EI t²/(2 s² w⁴) + EA
// ((s² - 1)² + (w² - 1)²)/8, where t is the angle per length, and the moment gives t = M s² w⁴/EI.
TEST(SpaceRun, CantileverRollsUp) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, "cantilever_roll_up", folder);
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable path = io::read_csv(folder + "/path.csv");
  EXPECT_EQ(path.columns, (Words{"step", "load_factor", "strip.tip_ux", "strip.tip_uy",
                                 "strip.tip_uz", "energy.strain", "iterations"}));
  EXPECT_EQ(path.n_rows(), 21u);
  const double x = 1 + path.numbers("strip.tip_ux").back(), z = path.numbers("strip.tip_uz").back();
  const double c = 0.01, ea = 1e9 * c, ei = ea * c * c / 12, moment = 523.5987755982989;
  double s = 1, w = 1, t = 0;
  for (int k = 0; k < 50; ++k) {
    t = moment * s * s * std::pow(w, 4) / ei;
    const double bending = ei / ea * t * t / (s * s * std::pow(w, 4));
    s = std::sqrt(1 + 2 * bending / (s * s));
    w = std::sqrt(1 + 4 * bending / (w * w));
  }
  // The error of the mesh is 2.5e-4 and of order 4: 3.8e-3 on 8 elements, 1.6e-5 on 32.
  EXPECT_LT(std::hypot(x - s * std::sin(t) / t, z - s * (1 - std::cos(t)) / t), 5e-4);
  const double energy = 0.5 * ei * t * t / (s * s * std::pow(w, 4)) +
                        ea / 8 * (std::pow(s * s - 1, 2) + std::pow(w * w - 1, 2));
  EXPECT_NEAR(path.numbers("energy.strain").back() / (0.2 * energy), 1, 1e-3);
  EXPECT_EQ(frames(folder), 21u);
  EXPECT_TRUE(fs::is_regular_file(folder + "/plots/path.svg"));
  EXPECT_TRUE(fs::is_regular_file(folder + "/plots/shapes.svg"));
  const json written = run_json(folder);
  EXPECT_TRUE(written["static"]["completed"].get<bool>());
  EXPECT_NEAR(written["static"]["load_factor"].get<double>(), 1, 1e-12);
  EXPECT_TRUE(written["expect"]["strip.tip_ux"]["holds"].get<bool>());
}

TEST(SpaceRun, ArcLengthGoesTheSameWay) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, "square_plate_twist", folder, {"static.path=arc_length"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable path = io::read_csv(folder + "/path.csv");
  const auto factor = path.numbers("load_factor"), z = path.numbers("plate.corner_uz");
  ASSERT_GE(factor.size(), 3u);
  for (size_t i = 1; i < factor.size(); ++i)
    EXPECT_NEAR(z[i], 7.8e-6 * factor[i], 1e-4 * std::abs(z[i])) << i;
}

// Reference for h16: P L² / (2 D (1 - ν)) of Timoshenko's pure twist. The shapes h12 converge to
// 0.88 of this value.
TEST(SpaceRun, SquarePlateTwists) {
  const Scratch scratch;
  const auto twist = [&](const std::string& shape) {
    const std::string folder = scratch / shape;
    const Ended ended = run(scratch, "square_plate_twist", folder, {"body.shape=" + shape});
    EXPECT_EQ(ended.code, 0) << ended.err;
    return io::read_csv(folder + "/path.csv").numbers("plate.corner_uz").back();
  };
  const double D = 1e9 * 1e-6 / 12 / (1 - 0.09), theory = 1e-3 / (2 * D * 0.7);
  EXPECT_NEAR(twist("h16") / theory, 1, 1e-6);
  // Reference for h12: another, earlier implementation of the incomplete shapes gives 0.890 on 8 x
  // 8 elements and converges to 0.880.
  EXPECT_NEAR(twist("h12") / theory, 0.890, 0.001);
}

TEST(SpaceRun, SleeveLetsTheStripSlide) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, "elastic_sleeve", folder, {"time.end=0.1"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable motion = io::read_csv(folder + "/motion.csv");
  EXPECT_EQ(motion.columns,
            columns({"time", "strip.front_x", "strip.front_y", "strip.front_z", "strip.back_x",
                     "strip.back_y", "strip.back_z", "strip.line_3"}));
  // While the strip is nearly straight it slides as a rigid body by ½ g_x t² through the
  // frictionless sleeve. Bending changes this by the order of the squared slope, 3 %.
  const double slid = 0.42 - motion.numbers("strip.line_3").back();
  EXPECT_NEAR(slid / (0.5 * 1.0 * 0.1 * 0.1), 1, 0.03);
  const auto kinetic = motion.numbers("energy.kinetic"),
             energy_error = motion.numbers("energy.error");
  for (const double each : energy_error) EXPECT_LT(std::abs(each), 1e-5 * kinetic.back());
  EXPECT_EQ(frames(folder), 11u);
}

// Where the strip leaves a sleeve at its root, lines of nodes are inserted, and the energy balance
// remains correct.
TEST(SpaceRun, AFreeRootGetsNewLines) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended = run(scratch, "elastic_sleeve", folder,
                          {"body.line=[{index=0, free=true, max_length=0.15}]",
                           "joint=[{type='sleeve', body='strip', edge='root', mode='direction'}]",
                           "gravity=[4.0, 0.0, -0.5]", "time.end=0.2", "output.vtk=false"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable motion = io::read_csv(folder + "/motion.csv");
  // Reference: free fall; the tolerance covers the sag.
  EXPECT_NEAR(motion.numbers("strip.line_0").back() / (-0.5 * 4.0 * 0.2 * 0.2), 1, 0.03);
  const json written = run_json(folder);
  ASSERT_EQ(written["motion"]["events"].size(), 1u);
  EXPECT_EQ(written["motion"]["events"][0]["change"], "insertion");
  EXPECT_LT(written["motion"]["energy_error"].get<double>(), 1e-3);
}

// A line that meets its neighbour ends the run with a message, and the earlier steps are kept.
TEST(SpaceRun, ALineThatReachesItsNeighbourSaysSo) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, "elastic_sleeve", folder,
          {"joint=[{type='sleeve', body='strip', edge='line 3'}, {type='line_drive', "
           "body='strip', line=3, speed=-4.0}]",
           "output.vtk=false"});
  EXPECT_EQ(ended.code, 3) << ended.out;
  EXPECT_TRUE(contains(ended.err, "cross"));
  EXPECT_GT(io::read_csv(folder + "/motion.csv").n_rows(), 5u);
}

TEST(SpaceRun, PlateDeploysAndGetsNewLines) {
  const Scratch scratch;
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, "deploying_plate", folder, {"time.end=0.15", "body.flow.mesh=split"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const io::CsvTable motion = io::read_csv(folder + "/motion.csv");
  EXPECT_EQ(motion.columns, columns({"time", "plate.length", "plate.tip_x", "plate.tip_y",
                                     "plate.tip_z", "hub.force_x", "hub.force_y", "hub.moment",
                                     "hub.power", "hub.force_z", "hub.moment_x", "hub.moment_y"}));
  EXPECT_NEAR(motion.numbers("plate.length").back(), 0.475, 1e-12);
  // The hub carries the weight of the material outside, whose lever is half its length. The
  // deviation is due to material that accelerates along the slope w' = 0.019 of the sag; it is at
  // most ρ h b v² w' = 0.007 N.
  EXPECT_NEAR(motion.numbers("hub.force_z").front(), 2700 * 0.005 * 0.1 * 0.4 * 9.81, 0.007);
  EXPECT_NEAR(motion.numbers("hub.moment_y").front(), -2700 * 0.005 * 0.1 * 0.08 * 9.81,
              0.007 * 0.4);
  // Static sag at the start: ρ c g L⁴ / (8 E I) for a strip that is free to contract laterally, and
  // 1 - ν² times this value for one that is not. The clamped root lies between both.
  const double weight = 2700 * 0.005 * 9.81, EI = 7e9 * std::pow(0.005, 3) / 12;
  const double sag = -motion.numbers("plate.tip_z")[0] / (weight * std::pow(0.4, 4) / (8 * EI));
  EXPECT_GT(sag, 1 - 0.09);
  EXPECT_LT(sag, 1);
  // The energy is balanced, except for the energy that the new line sets free at 0.1 s, because the
  // coarser mesh before was too stiff.
  const auto time = motion.numbers("time"), energy_error = motion.numbers("energy.error"),
             kinetic = motion.numbers("energy.kinetic"), strain = motion.numbers("energy.strain");
  for (size_t i = 0; i < time.size(); ++i)
    EXPECT_LT(std::abs(energy_error[i]), time[i] < 0.1005 ? 1e-5 * kinetic[i] : 0.01 * strain[i]);
  const json written = run_json(folder);
  EXPECT_LT(written["motion"]["energy_error"].get<double>(), 2e-3);
  const json& events = written["motion"]["events"];
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0]["change"], "insertion");
  EXPECT_NEAR(events[0]["time"].get<double>(), 0.1, 1e-12);
  // The insertion changes neither the sag nor the momentum, up to the error of the coarser mesh at
  // the root.
  EXPECT_LT(events[0]["tip_jump"].get<double>(), 1e-3 * -motion.numbers("plate.tip_z")[0]);
  EXPECT_LT(events[0]["momentum_jump"].get<double>(), 1e-5 * 2700 * 0.005 * 0.1 * 0.45 * 0.5);
}

TEST(SpaceRun, CheckListsTheNewParts) {
  const Scratch scratch;
  const auto halves = [&](const std::string& name) {
    const std::string out = flexmorph(scratch, {"check", name}).out;
    const size_t middle = std::min(out.find("\nabsent"), out.size());
    return std::pair(out.substr(0, middle), out.substr(middle));
  };
  const auto [pendulum, no_pendulum] = halves("plate_pendulum");
  for (const char* part : {"out-of-plane", "bending", "972 unknowns", "gravity", "observed points"})
    EXPECT_TRUE(contains(pendulum, part));
  for (const char* part : {"static analysis", "free material lines", "loads"})
    EXPECT_TRUE(contains(no_pendulum, part));
  EXPECT_FALSE(contains(no_pendulum, "out-of-plane"));
  const auto [roll, no_roll] = halves("cantilever_roll_up");
  EXPECT_TRUE(contains(roll, "static analysis"));
  EXPECT_TRUE(contains(roll, "load on strip"));
  EXPECT_TRUE(contains(no_roll, "motion"));
  EXPECT_FALSE(contains(no_roll, "static analysis"));
  const auto [sleeve, no_sleeve] = halves("elastic_sleeve");
  EXPECT_TRUE(contains(sleeve, "free material line 3"));
  EXPECT_FALSE(contains(no_sleeve, "free material line"));
}

}  // namespace
}  // namespace flexmorph::test
