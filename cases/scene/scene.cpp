#include "cases/scene/scene.h"

#include <cmath>
#include <filesystem>

#include "cases/scene/read.h"

namespace flexmorph::cases {
namespace {

Output read_output(const io::Table& root) {
  Output output;
  output.motion_every = 0.01;
  if (!root.has("output")) return output;
  constexpr int kMost = 1'000'000'000;
  const io::Table t = root.table("output");
  output.directory = t.string("directory", "a folder", "");
  output.design_every = t.integer("design_every", "a number of iterations", 0, kMost, 1);
  output.motion_every = t.number("motion_every", io::not_negative("a time", "s"), 0.01);
  output.sharp_every = t.integer("sharp_every", "a number of iterations", 0, kMost, 25);
  output.vtk = t.boolean("vtk", true);
  output.plots = t.boolean("plots", true);
  return output;
}

Expectation read_expectation(const io::Table& t) {
  Expectation expected;
  expected.place = t.place();
  const auto bound = [&](const char* key) -> std::optional<double> {
    if (!t.has(key)) return {};
    return t.number(key, io::any_number("a bound"));
  };
  expected.at_least = bound("at_least");
  expected.at_most = bound("at_most");
  if (t.has("value")) {
    expected.value = t.number("value", io::any_number("an expected value"));
    if (t.has("relative") == t.has("absolute"))
      t.fail("a value comes with one tolerance, `relative` or `absolute`");
    expected.tolerance = t.has("relative") ? t.number("relative", io::not_negative("a tolerance")) *
                                                 std::abs(*expected.value)
                                           : t.number("absolute", io::not_negative("a tolerance"));
  }
  if (!expected.value && !expected.at_least && !expected.at_most)
    t.fail("an expectation has a `value` with a tolerance, `at_least` or `at_most`");
  return expected;
}

}  // namespace

TdfSettings BodyDesign::stage(size_t index) const {
  TdfSettings settings = tdf;
  settings.band =
      tdf.kind == TdfSettings::Kind::paper ? band.at(index) : band.at(index) * grid.dx();
  // The topology is found without erosion; the last stage closes the slits that it leaves.
  if (index + 1 < band.size()) settings.erosion = 0;
  return settings;
}

int Esl::count(double end) const { return static_cast<int>(std::floor(end / every + 1e-6)); }

bool Expectation::holds(double found) const {
  // Written so that NaN holds nowhere.
  return std::isfinite(found) && (!value || std::abs(found - *value) <= tolerance) &&
         (!at_least || found >= *at_least) && (!at_most || found <= *at_most);
}

double Body::length_at(double time) const {
  if (!flow) return length;
  return flow->motion ? flow->motion(time).value : length + flow->speed * time;
}

double Body::longest(double end) const {
  return flow && flow->motion ? flow->longest : std::max(length, length_at(end));
}

double Body::shortest(double end) const {
  return flow && flow->motion ? flow->shortest : std::min(length, length_at(end));
}

std::vector<double> Body::start_lines(double root, int count) const {
  std::vector<double> out;
  for (int i = 0; i <= count; ++i) out.push_back(root + length * i / count);
  for (const BodyLine& line : lines)
    if (line.at) out[static_cast<size_t>(line.index)] = *line.at;
  return out;
}

bool Scene::has_free_lines() const {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& b) { return b.has_free_lines(); });
}

bool Scene::has_heat() const {
  return std::any_of(bodies.begin(), bodies.end(),
                     [](const Body& b) { return b.heat.has_value(); });
}

const Body& Scene::body(const std::string& body_name) const {
  for (const Body& each : bodies)
    if (each.name == body_name) return each;
  throw Error::input("there is no body '" + body_name + "' in this scene");
}

const std::vector<std::string>& element_names() {
  static const std::vector<std::string> kNames{"ancf_plate", "ale_ancf_plate", "ancf_beam"};
  return kNames;
}

const std::vector<std::string>& plate_shapes() {
  static const std::vector<std::string> kNames{"h16", "h12"};
  return kNames;
}

std::string Verify::words() const {
  if (!mesh) return std::to_string(refine) + " times the elements in each direction";
  return std::to_string((*mesh)[0]) + " x " + std::to_string((*mesh)[1]) + " elements";
}

fem::Motion Body::length_motion(double t) const {
  if (flow && flow->motion) return flow->motion(t);
  return {length_at(t), flow ? flow->speed : 0, 0};
}

std::function<fem::Motion(double)> Scene::motion_of(const Law& law) const {
  if (law.drive.empty()) return [value = law.value](double) { return fem::Motion{value, 0, 0}; };
  return std::find_if(drives.begin(), drives.end(),
                      [&](const Drive& d) { return d.name == law.drive; })
      ->motion;
}

bool Scene::follows_trajectory(const Law& law) const {
  return std::any_of(drives.begin(), drives.end(),
                     [&](const Drive& d) { return d.from_trajectory && d.name == law.drive; });
}

bool is_whole(double ratio) {
  return std::abs(ratio - std::round(ratio)) <= 1e-6 * std::max(1.0, std::abs(ratio));
}

Scene read_scene(const io::CaseFile& file, const Follow& follow) {
  const io::Table root = file.root();
  Scene scene;
  scene.name = std::filesystem::path(file.path()).stem().string();
  scene.title = root.string("title", "a title", scene.name);
  if (root.has("domain"))
    read_static(root, scene);
  else
    read_motion(root, follow, scene);
  read_designs(root, scene);
  scene.output = read_output(root);
  if (root.has("accuracy")) scene.accuracy = read_accuracy(root.table("accuracy"));
  if (root.has("expect")) {
    const io::Table expect = root.table("expect");
    for (const std::string& key : expect.keys())
      scene.expect[key] = read_expectation(expect.table(key));
  }
  file.finish();
  return scene;
}

}  // namespace flexmorph::cases
