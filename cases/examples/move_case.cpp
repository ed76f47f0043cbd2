// Loads a case, computes its motion in memory and prints a column of its table.
//   move_case CASE COLUMN [KEY=VALUE]...
#include <cstdio>

#include "cases/run/compute.h"

using namespace flexmorph;

namespace {

const std::vector<double>& column_of(const cases::Series& table, const std::string& name) {
  if (const std::vector<double>* column = table.find(name)) return *column;
  std::string known;
  for (const cases::ColumnInfo& each : table.columns) known += " " + each.name;
  throw Error::input("there is no column '" + name + "', but:" + known);
}

void print_motion(const char* name, const char* column, std::span<const std::string> changes) {
  const cases::PreparedCase prepared = cases::load_case(name, changes);
  const cases::RunResult result = cases::compute(prepared);
  if (!result.motions.motion) throw Error::input("this case has no motion");
  const cases::MotionRecord& motion = *result.motions.motion;
  const std::vector<double>& values = column_of(motion.table, column);
  for (size_t row = 0; row < values.size(); ++row)
    std::printf("%.6g %.9g\n", motion.time()[row], values[row]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fputs("usage: move_case CASE COLUMN [KEY=VALUE]...\n", stderr), 2;
  try {
    print_motion(argv[1], argv[2], std::vector<std::string>(argv + 3, argv + argc));
  } catch (const Error& error) {
    std::fprintf(stderr, "move_case: %s\n", error.what());
    return error.kind() == Error::Kind::input ? 2 : 3;
  }
}
