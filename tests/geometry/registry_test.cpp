// Shows that a registry finds its rows by their names in their order, and refuses a second row with
// a name that exists, and a row without a name.
#include "geometry/registry.h"

#include <gtest/gtest.h>

namespace flexmorph {
namespace {

struct Row {
  std::string name;
};

TEST(Registry, FindsRowsByTheirNames) {
  const Row one{"one"}, two{"two"}, same{"one"}, none{""};
  Registry<Row> rows("joint", [](const Row& row) { return row.name; }, {&one});
  EXPECT_EQ(rows.find("two"), nullptr);
  rows.add(two);
  EXPECT_EQ(rows.find("one"), &one);
  EXPECT_EQ(rows.find("two"), &two);
  ASSERT_EQ(rows.rows().size(), 2u);
  EXPECT_EQ(rows.rows()[1], &two);
  try {
    rows.add(same);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::input);
    const std::string text = error.what();
    for (const char* part : {"joint", "'one'", "exists"})
      EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  EXPECT_THROW(rows.add(none), Error);
  EXPECT_EQ(rows.rows().size(), 2u);
}

}  // namespace
}  // namespace flexmorph
