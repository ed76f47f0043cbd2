#include "tests/cases/run_json.h"

#include "tests/io/scratch.h"

template class nlohmann::basic_json<>;

namespace flexmorph::test {

json run_json(const std::string& folder) { return json::parse(contents_of(folder + "/run.json")); }

}  // namespace flexmorph::test
