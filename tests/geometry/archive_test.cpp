// Shows that archived values are restored bit for bit, and that an incomplete archive is refused.
#include "geometry/archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flexmorph {
namespace {

struct Inner {
  std::string word;
  std::optional<double> value;
  void archive(Archive& m) { m(word, value); }
};

struct All {
  double x = 0;
  int n = 0;
  bool yes = false;
  std::string text;
  VectorXd vector;
  MatrixXd matrix;
  Vec3 location = Vec3::Zero();
  std::vector<int> numbers;
  std::vector<Inner> inner;
  std::vector<std::vector<Vec2>> outlines;
  std::array<int, 4> corners{};
  Eigen::SparseMatrix<double> sparse;
  std::optional<Inner> absent, present;
};
void archive(Archive& m, All& a) {
  m(a.x, a.n, a.yes, a.text, a.vector, a.matrix, a.location, a.numbers, a.inner, a.outlines,
    a.corners, a.sparse, a.absent, a.present);
}

All something() {
  All a;
  a.x = std::nextafter(0.1, 1);
  a.n = -7;
  a.yes = true;
  a.text = std::string("with a \0 in it\n", 15);
  a.vector = VectorXd::LinSpaced(5, 0, 1);
  a.vector[3] = std::numeric_limits<double>::quiet_NaN();
  a.matrix = MatrixXd::Random(3, 2);
  a.location = {1, -0.0, 3e-320};
  a.numbers = {3, 1, 2};
  a.inner = {{"one", 1.5}, {"", {}}};
  a.outlines = {{}, {Vec2(1, 2), Vec2(3, 4)}};
  a.corners = {1, 2, 3, 4};
  a.sparse.resize(3, 4);
  a.sparse.insert(2, 1) = 4;
  a.sparse.insert(0, 3) = -1;
  a.present = Inner{"there", 2.0};
  return a;
}

std::string saved_checkpoint(All a) {
  Archive m;
  m(a);
  return m.bytes();
}

TEST(Archive, PutsBackBitForBit) {
  const std::string bytes = saved_checkpoint(something());
  All other;
  other.absent = Inner{"is not", {}};
  other.numbers = {9};
  Archive back(bytes);
  EXPECT_TRUE(back.is_restoring());
  back(other);
  EXPECT_EQ(saved_checkpoint(other), bytes);
  EXPECT_EQ(other.x, std::nextafter(0.1, 1));
  EXPECT_TRUE(std::isnan(other.vector[3]));
  EXPECT_TRUE(std::signbit(other.location.y()));
  EXPECT_EQ(other.sparse.coeff(2, 1), 4);
  EXPECT_EQ(other.sparse.nonZeros(), 2);
  EXPECT_FALSE(other.absent);
  EXPECT_EQ(other.present->word, "there");
  EXPECT_EQ(other.inner[0].value, 1.5);
}

TEST(Archive, RefusesWhatEndsTooSoon) {
  const std::string bytes = saved_checkpoint(something());
  for (size_t n = 0; n < bytes.size(); ++n) {
    Archive back(bytes.substr(0, n));
    All other;
    EXPECT_THROW(back(other), Error) << n;
  }
}

TEST(Archive, KnowsWhatWasUpToDate) {
  int old = 3, current = 5;
  Archive m;
  EXPECT_FALSE(m.up_to_date(old, 5));
  EXPECT_TRUE(m.up_to_date(current, 5));
  Archive back(m.bytes());
  int a = 0, b = 0;
  EXPECT_FALSE(back.up_to_date(a, 2));
  EXPECT_TRUE(back.up_to_date(b, 2));
  EXPECT_EQ(a, -1);
  EXPECT_EQ(b, 2);
}

// The expected number is the check value of the standard.
TEST(Checksum, IsThatOfEcma182) { EXPECT_EQ(checksum("123456789"), 0x6C40DF5F0B497347ULL); }

}  // namespace
}  // namespace flexmorph
