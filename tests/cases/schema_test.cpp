// Shows that the JSON schema of case files accepts every shipped case and refuses broken ones. The
// schema is evaluated by an independent validator (valijson).

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "cases/assembly/build.h"
#include "cases/check/ready.h"
#include "cases/keys/book.h"
#include "io/case_files/case_parser.h"
#include "tests/cases/program.h"

namespace flexmorph::test {
namespace {

class Schema : public ::testing::Test {
 protected:
  Schema() {
    const nlohmann::json json = nlohmann::json::parse(cases::keys_as_schema());
    valijson::SchemaParser(valijson::SchemaParser::kDraft7)
        .populateSchema(valijson::adapters::NlohmannJsonAdapter(json), schema_);
  }
  /// Returns the schema errors of a case; empty if there are none.
  std::string verify(const std::string& toml_text) const {
    std::ostringstream text;
    text << toml::json_formatter(toml::parse(toml_text));
    const nlohmann::json json = nlohmann::json::parse(text.str());
    valijson::Validator validator;
    valijson::ValidationResults results;
    const valijson::adapters::NlohmannJsonAdapter target(json);
    if (validator.validate(schema_, target, &results)) return "";
    std::string out;
    for (const auto& error : results) {
      for (const std::string& part : error.context) out += part;
      out += ": " + error.description + "\n";
    }
    return out;
  }
  valijson::Schema schema_;
};

TEST_F(Schema, TakesAllShippedCases) {
  for (const std::string& name : cases::shipped_cases())
    EXPECT_EQ(verify(io::read_text(cases::find_case(name))), "") << name;
}

TEST_F(Schema, RefusesBrokenCases) {
  const std::string whole = io::read_text(FLEXMORPH_SHORT_CASE);
  ASSERT_EQ(verify(whole), "");
  struct Break {
    const char *from, *to;
  };
  for (const Break& each :
       {Break{"step = 1e-3", "step = -1e-3"},   // below its range
        Break{"step = 1e-3", "step = [1e-3]"},  // a list instead of a number
        Break{"step = 1e-3", "stepp = 1e-3"},   // an unknown key
        Break{"end = 0.12", ""},                // a missing key that is required
        Break{"end = 0.12", "end = true"},      // true instead of a number
        Break{"element = \"ale_ancf_plate\"", "element = \"plate\""},
        Break{"poisson_ratio = 0.3", "poisson_ratio = 0.7"},
        Break{"elements = [10, 2]", "elements = [10, 2, 2]"},
        Break{"elements = [10, 2]", "elements = [10, 0.5]"},
        Break{"terms = [\"inertia\", \"membrane\"]", "terms = []"},
        Break{"terms = [\"inertia\", \"membrane\"]", "terms = [\"inertia\", \"inertia\"]"},
        Break{"[[hub]]", "[hub]"},  // a table instead of a list
        Break{"[time]", "[tyme]"}}) {
    std::string broken = whole;
    const size_t at = broken.find(each.from);
    ASSERT_NE(at, std::string::npos) << each.from;
    broken.replace(at, std::string(each.from).size(), each.to);
    EXPECT_NE(verify(broken), "") << each.to;
  }
}

}  // namespace
}  // namespace flexmorph::test
