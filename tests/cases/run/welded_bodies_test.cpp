// Shows that plates and beams welded to each other are correct: two strips in line against one of
// an equal mesh, an L-shaped frame and a portal against the textbook, plates instead of beams, the
// energy of a swinging frame, forces against weight; and that impossible welds are refused.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <numbers>

#include "cases/assembly/build.h"
#include "io/tables.h"
#include "tests/cases/program.h"
#include "tests/support/errors.h"

namespace flexmorph::test {
namespace {

constexpr double kRight = std::numbers::pi / 2;

/// A strip that is modelled as a plate or as a beam.
struct Strip {
  std::string name;
  bool beam = false;
  double length = 0.4, depth = 0.1, thickness = 0.01, modulus = 2e11;
  std::array<int, 2> elements{4, 1};

  std::string toml() const {
    std::string out = "\n[[body]]\nname = \"" + name + "\"\n";
    const auto add = [&](const std::string& key, const std::string& value) {
      out += key + " = " + value + "\n";
    };
    if (beam) {
      add("element", "\"ancf_beam\"\nterms = [\"inertia\", \"ecm\"]");
      add("height", exact_text(depth));
      add("width", exact_text(thickness));
      add("elements", std::to_string(elements[0]));
    } else {
      add("element", "\"ancf_plate\"\nspace = \"plane\"\nterms = [\"inertia\", \"membrane\"]");
      add("width", exact_text(depth));
      add("thickness", exact_text(thickness));
      add("elements", "[" + std::to_string(elements[0]) + ", " + std::to_string(elements[1]) + "]");
    }
    add("length", exact_text(length));
    add("density", "7800.0\npoisson_ratio = 0.3");
    add("youngs_modulus", exact_text(modulus));
    return out;
  }
};

std::string in_hub(const std::string& body, const std::string& hub, double angle = 0) {
  return "\n[[joint]]\ntype = \"weld\"\nbody = \"" + body + "\"\nedge = \"root\"\nto = \"" + hub +
         "\"\nangle = " + exact_text(angle) + "\n";
}

/// @param more  further lines of the table of the weld
std::string welded(const std::string& body, const std::string& edge, const std::string& to,
                   const std::string& to_edge, const std::string& more = "") {
  return "\n[[joint]]\ntype = \"weld\"\nbody = \"" + body + "\"\nedge = \"" + edge + "\"\nto = \"" +
         to + "\"\nto_edge = \"" + to_edge + "\"\n" + more + "\n";
}

std::string seen(const std::string& body, double x) {
  return "\n[[observe]]\nname = \"tip\"\nbody = \"" + body + "\"\npoint = [" + exact_text(x) +
         ", 0.0]\n";
}

std::string pulled(const std::string& body, double x, double force_x, double force_y) {
  return "\n[[load]]\ntype = \"point\"\nbody = \"" + body + "\"\npoint = [" + exact_text(x) +
         ", 0.0]\nforce = [" + exact_text(force_x) + ", " + exact_text(force_y) + "]\n";
}

io::CsvTable table_of(const Scratch& scratch, const std::string& text, const std::string& table) {
  const std::string folder = scratch / "out";
  const Ended ended =
      run(scratch, scratch.write("case.toml", text), folder, {"output.plots=false"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  return io::read_csv(folder + "/" + table);
}

/// Returns one strip of 0.8 m in a hub that swings, or two strips of 0.4 m whose second one is
/// welded at its end `edge`. The strips bend by 0.1 m.
std::string swinging(bool beam, const std::string& edge) {
  const std::string start = R"toml(
title = "Strips in a hub"
gravity = [0.0, -9.81]
[time]
start = "rigid"
step = 2e-3
end = 0.2
[[drive]]
name = "turn"
formula = "0.4*(8*t - sin(8*t))"
[[hub]]
name = "shaft"
position = [0.1, 0.2]
angle = "turn"
)toml";
  Strip strip{"inner", beam, 0.8, 0.1, 0.01, 1e8, {4, 2}};
  if (edge.empty()) return start + strip.toml() + in_hub("inner", "shaft") + seen("inner", 0.8);
  strip.length = 0.4;
  strip.elements = {2, 2};
  std::string out = start + strip.toml();
  strip.name = "outer";
  return out + strip.toml() + in_hub("inner", "shaft") +
         welded("outer", edge, "inner", "free_end", "mode = \"full\"") +
         seen("outer", edge == "root" ? 0.4 : 0);
}

// With all derivatives continuous at the weld the two strips have the motion of one strip with an
// equal mesh, up to the tolerance of Newton's method.
TEST(WeldedBodies, ThatGoOnStraightAreOne) {
  for (const bool beam : {false, true}) {
    const Scratch scratch;
    const io::CsvTable one = table_of(scratch, swinging(beam, ""), "motion.csv");
    for (const char* edge : {"root", "free_end"}) {
      const io::CsvTable two = table_of(scratch, swinging(beam, edge), "motion.csv");
      double apart = 0, moved = 0;
      for (const std::string axis : {"_x", "_y"}) {
        const std::vector<double> a = one.numbers("inner.tip" + axis),
                                  b = two.numbers("outer.tip" + axis);
        ASSERT_EQ(a.size(), b.size());
        for (size_t i = 0; i < a.size(); ++i) {
          apart = std::max(apart, std::abs(a[i] - b[i]));
          moved = std::max(moved, std::abs(a[i] - a[0]));
        }
      }
      EXPECT_GT(moved, 0.05);
      EXPECT_LT(apart, 1e-8) << beam << edge;
      std::cout << (beam ? "beams, " : "plates, ") << edge << ": " << apart << " m apart"
                << std::endl;
    }
  }
}

/// Returns the deflection under a force at the end: of two plates welded in the middle, or of one,
/// in a wall.
double deflection(const std::string& mode, int fine) {
  const std::string start = "title = \"Strips\"\n[static]\n[[hub]]\nname = \"wall\"\n";
  Strip strip{"inner", false, 0.4, 0.1, 0.01, 1e8, {4 * fine, 2 * fine}};
  std::string text = start;
  if (mode.empty()) {
    text +=
        strip.toml() + in_hub("inner", "wall") + pulled("inner", 0.4, 0, -30) + seen("inner", 0.4);
  } else {
    strip.length = 0.2;
    strip.elements[0] /= 2;
    text += strip.toml() + in_hub("inner", "wall");
    strip.name = "outer";
    text += strip.toml() + welded("outer", "root", "inner", "free_end", mode) +
            pulled("outer", 0.2, 0, -30) + seen("outer", 0.2);
  }
  const Scratch scratch;
  return table_of(scratch, text, "path.csv")
      .numbers((mode.empty() ? "inner" : "outer") + std::string(".tip_uy"))
      .back();
}

// With mode "edge" strains may jump at the weld. These jumps vanish under refinement: the
// difference decreases with the mesh.
TEST(WeldedBodies, WithJumpsOfStrainConverge) {
  double last = 0;
  for (const int fine : {1, 2}) {
    const double one = deflection("", fine), full = deflection("mode = \"full\"", fine),
                 edge = deflection("", fine) - deflection("mode = \"edge\"", fine);
    EXPECT_LT(one, -5e-3);
    EXPECT_NEAR(full, one, 1e-10);
    std::cout << fine << ": " << one << " m, the weld of edges " << edge << " m more" << std::endl;
    EXPECT_GT(edge, 0);  // fewer constraints make it softer
    if (fine > 1) {
      EXPECT_LT(edge, last / 4);
    }
    last = edge;
  }
}

constexpr double kColumn = 1.2, kSegment = 0.8, kDepth = 0.02, kThick = 0.03, kForce = 0.5;
constexpr double kBending = 2e11 * kThick * kDepth * kDepth * kDepth / 12;  // EI [N m²]

/// Returns the tip displacement of a column in a wall with a leg to the right that is pulled down
/// at its end. The leg is listed first.
std::array<double, 2> corner(bool beam_column, bool beam_leg, int fine) {
  const Strip column{"column", beam_column, kColumn, kDepth, kThick, 2e11, {12 * fine, 1}};
  const Strip leg{"leg", beam_leg, kSegment, kDepth, kThick, 2e11, {8 * fine, 1}};
  const Scratch scratch;
  const io::CsvTable path =
      table_of(scratch,
               "title = \"A corner\"\n[static]\nsteps = 1\n[[hub]]\nname = \"wall\"\n" +
                   leg.toml() + column.toml() + in_hub("column", "wall", kRight) +
                   welded("leg", "root", "column", "free_end", "angle = " + exact_text(-kRight)) +
                   pulled("leg", kSegment, 0, -kForce) + seen("leg", kSegment),
               "path.csv");
  return {path.numbers("leg.tip_ux").back(), path.numbers("leg.tip_uy").back()};
}

// Reference: bending of the column under P L and of the leg under P. Neglected are stretch and
// shear, (d/L)² = 6e-4 of the leg's deflection, which is a fifth of the total, and the nonlinearity
// of deflections of 1e-4 of the length.
TEST(WeldedBodies, MakeAFrame) {
  const double down = kForce * kSegment * kSegment * (kSegment / 3 + kColumn) / kBending,
               aside = kForce * kSegment * kColumn * kColumn / (2 * kBending);
  const auto [x, y] = corner(true, true, 2);
  EXPECT_NEAR(y, -down, 1e-3 * down);
  EXPECT_NEAR(x, aside, 1e-3 * aside);
}

// A plate instead of a beam differs only near its ends, which keep their width, over a length of
// about the depth: 1/60 and 1/40 of the strips.
TEST(WeldedBodies, TakePlatesForBeams) {
  const double beams = corner(true, true, 1)[1];
  for (const auto& [beam_column, beam_leg] : {std::pair(true, false), std::pair(false, true)}) {
    double off[2];
    for (const int fine : {1, 2})
      off[fine - 1] = std::abs(corner(beam_column, beam_leg, fine)[1] / beams - 1);
    std::cout << "column " << (beam_column ? "beam" : "plate") << ", leg "
              << (beam_leg ? "beam" : "plate") << ": off by " << off[0] << ", " << off[1]
              << std::endl;
    EXPECT_LT(off[1], 5e-3);
  }
}

// A portal on two walls closes a kinematic chain. Reference: sway by the slope-deflection method
// with joints rotated by θ,
//   (4/H + 6/L) θ = 6 Δ/H²,   P = 2 EI (12 Δ/H³ - 6 θ/H²)
TEST(WeldedBodies, CloseAChain) {
  const Strip left{"left", true, kColumn, kDepth, kThick, 2e11, {24, 1}};
  Strip right = left, beam = left;
  right.name = "right";
  beam.name = "beam";
  beam.length = kSegment;
  const Scratch scratch;
  const io::CsvTable path = table_of(
      scratch,
      "title = \"A portal\"\n[static]\nsteps = 1\n[[hub]]\nname = \"a\"\n[[hub]]\nname = \"b\"\n"
      "position = [0.8, 0.0]\n" +
          left.toml() + right.toml() + beam.toml() + in_hub("left", "a", kRight) +
          in_hub("right", "b", kRight) +
          welded("beam", "root", "left", "free_end", "angle = " + exact_text(-kRight)) +
          welded("beam", "free_end", "right", "free_end", "angle = " + exact_text(-kRight)) +
          pulled("beam", 0, 1, 0) + seen("beam", 0.5 * kSegment),
      "path.csv");
  const double turn = 6 / (kColumn * kColumn) / (4 / kColumn + 6 / kSegment);  // θ/Δ
  const double sway =
      1 / (2 * kBending * (12 / std::pow(kColumn, 3) - 6 * turn / (kColumn * kColumn)));
  EXPECT_NEAR(path.numbers("beam.tip_ux").back(), sway, 2e-3 * sway);
}

// A frame that falls around a pin keeps its energy, as the integrator guarantees: with bilinear
// constraints (beams, partial) and with linear ones.
TEST(WeldedBodies, KeepTheirEnergy) {
  for (const bool beam : {true, false}) {
    const Strip column{"column", true, 0.4, 0.04, 0.01, 1e7, {4, 1}};
    const Strip leg{"leg", beam, 0.3, 0.04, 0.01, 1e7, {3, 1}};
    const Scratch scratch;
    const io::CsvTable motion = table_of(
        scratch,
        "title = \"A falling frame\"\ngravity = [0.0, -9.81]\n[time]\nstep = 2e-3\nend = 0.2\n"
        "start = \"rigid\"\nintegrator = \"energy_momentum\"\n" +
            column.toml() + "position = [0.0, 0.0]\n" + leg.toml() +
            welded("leg", "root", "column", "free_end", "angle = -1.0") +
            "\n[[joint]]\ntype = \"pin\"\nbody = \"column\"\npoint = [0.0, 0.0]\n",
        "motion.csv");
    const auto kinetic = motion.numbers("energy.kinetic"), strain = motion.numbers("energy.strain"),
               potential = motion.numbers("energy.potential");
    const double all = kinetic[0] + strain[0] + potential[0];
    for (size_t i = 0; i < kinetic.size(); ++i)
      EXPECT_NEAR(kinetic[i] + strain[i] + potential[i], all, 1e-9);
    EXPECT_GT(kinetic.back(), 0.1);
    EXPECT_GT(strain.back(), 1e-4);
  }
}

// A static named weld carries the weight behind it and its moment about the middle of the edge; the
// strips deflect by 1e-5 of their length.
TEST(WeldedBodies, CarryWeight) {
  for (const bool beam : {false, true}) {
    const Scratch scratch;
    const io::CsvTable motion =
        table_of(scratch,
                 "title = \"Strips\"\ngravity = [0.0, -9.81]\n[time]\nstep = 1e-3\nend = 0.01\n"
                 "[[hub]]\nname = \"wall\"\nangular_velocity = 0.0\n" +
                     Strip{"inner", false}.toml() + Strip{"outer", beam, 0.3}.toml() +
                     in_hub("inner", "wall") +
                     welded("outer", "root", "inner", "free_end", "name = \"seam\""),
                 "motion.csv");
    const double weight = 7800 * 0.3 * 0.1 * 0.01 * 9.81;
    const auto x = motion.numbers("seam.force_x"), y = motion.numbers("seam.force_y"),
               moment = motion.numbers("seam.moment");
    for (size_t i = 0; i < x.size(); ++i) {
      EXPECT_NEAR(x[i], 0, 1e-3 * weight);
      EXPECT_NEAR(y[i], weight, 1e-3 * weight);
      EXPECT_NEAR(moment[i], 0.15 * weight, 1e-3 * weight);
    }
  }
}

const std::string kHeld =
    "title = \"Bad\"\n[time]\nstep = 1e-3\nend = 0.1\n"
    "[[hub]]\nname = \"wall\"\nangular_velocity = 0.0\n";

/// Returns the error message for a case file with these bodies in a hub.
std::string refusal(const std::string& bodies) {
  const Scratch scratch;
  const std::string file = scratch.write("bad.toml", kHeld + bodies);
  const std::string text =
      testing::error_of(Error::Kind::input, [&] { cases::read_scene(io::CaseFile(file)); });
  EXPECT_TRUE(testing::mentions(text, "bad.toml:")) << text;
  return text;
}

TEST(WeldedBodies, AreRefusedWhereEdgesDoNotMeet) {
  const auto mentions = [](const std::string& bodies, const std::vector<std::string>& parts) {
    EXPECT_TRUE(testing::mentions_all(refusal(bodies), parts));
  };
  const std::string a = Strip{"a"}.toml() + in_hub("a", "wall"), b = Strip{"b"}.toml(),
                    beam = Strip{"b", true}.toml();
  const auto weld = [](const std::string& more = "", const std::string& to = "a") {
    return welded("b", "root", to, "free_end", more);
  };
  mentions(a + b + weld("", "c"), {"joint.b.to = \"c\"", "'a', 'b'"});
  mentions(a + b + weld("", "b"), {"joint.b.to = \"b\"", "different"});
  mentions(a + b + "\n[[joint]]\ntype = \"weld\"\nbody = \"b\"\nedge = \"root\"\nto = \"a\"\n",
           {"joint.b.to_edge", "missing"});
  mentions(a + b + welded("b", "side_low", "a", "free_end"),
           {"joint.b.edge = \"side_low\"", "'root', 'free_end'"});
  mentions(a + b + weld("mode = \"direction\""),
           {"joint.b.mode = \"direction\"", "'partial', 'edge', 'full'"});
  mentions(a + b + weld("mode = \"partial\""),
           {"joint.b.mode = \"partial\"", "beams", "edge", "full"});
  mentions(a + beam + weld("mode = \"full\""),
           {"joint.b.mode = \"full\"", "plate", "beam", "edge"});
  mentions(a + b + weld("angle = 1.0"), {"joint.b.angle = 1.0", "0 or pi"});
  mentions(a + Strip{"b", false, 0.4, 0.1, 0.01, 2e11, {4, 2}}.toml() + weld(),
           {"joint.b.to = \"a\"", "'a'", "'b'", "width", "elements across"});
  mentions(a + Strip{"b", false, 0.4, 0.2}.toml() + weld(),
           {"joint.b.to = \"a\"", "'a'", "'b'", "width", "elements across"});
  mentions(a + b + weld() + weld(), {"joint.2.to_edge = \"free_end\"", "closed chain"});
  mentions(a + b + in_hub("b", "wall") + welded("b", "root", "a", "root"),
           {"joint.2.to_edge = \"root\"", "closed chain"});
  mentions(a + b + welded("b", "root", "a", "root") + in_hub("b", "wall"),
           {"joint.2.edge = \"root\"", "closed chain"});
  std::string growing = Strip{"a"}.toml();
  growing.replace(growing.find("ancf_plate"), 10, "ale_ancf_plate");
  growing += "[body.flow]\nspeed = 0.5\nmax_length = 0.1\n" + in_hub("a", "wall");
  mentions(growing + b + welded("b", "root", "a", "root"),
           {"joint.b.to_edge = \"root\"", "'a'", "material"});
}

// A designed plate may carry another plate. But on the cells of the design their nodes do not
// coincide; this is reported before anything is computed.
TEST(WeldedBodies, PartOnTheCellsOfADesign) {
  const std::string designed = Strip{"a"}.toml() + in_hub("a", "wall") + Strip{"b"}.toml() +
                               welded("b", "root", "a", "free_end") + R"toml(
[esl]
every = 0.01
[[design]]
body = "a"
cells = [40, 10]
components = [4, 1]
max_volume = 0.5
[optimizer]
name = "mma"
)toml";
  const Scratch scratch;
  const cases::Scene scene =
      cases::read_scene(io::CaseFile(scratch.write("good.toml", kHeld + designed)));
  EXPECT_EQ(scene.designs.size(), 1U);
  for (const char* more : {"[verify]\ncells = 1\n", "[certificate]\n"}) {
    const std::string text = refusal(designed + more);
    EXPECT_TRUE(testing::mentions_all(text, {"'b'", "'a'", "nodes", "cells"}));
  }
}

}  // namespace
}  // namespace flexmorph::test
