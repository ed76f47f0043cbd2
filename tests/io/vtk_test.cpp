// Shows that files for ParaView are right when VTK's readers read them: geometry, order, field
// values, frames of a growing series, picture size and orientation; and that repeated files have
// equal bytes.
#include "io/vtk.h"

#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUtilities.h>

#include <cmath>
#include <sstream>

#include "tests/io/scratch.h"

namespace flexmorph::io {
namespace {

constexpr double kFloat = 6e-8;  // half a unit in the last place of Float32

template <class Reader>
void read(Reader& reader, const std::string& path) {
  reader->SetFileName(path.c_str());
  reader->Update();
  EXPECT_EQ(reader->GetErrorCode(), 0u);
}

// The field is a function of the position: for any order in the file, each point and cell must have
// the value of its position.
TEST(ImageData, ValuesLieWhereTheyBelong) {
  const Scratch scratch;
  const CommaLocale comma;
  const Grid grid{.x0 = -0.5, .y0 = 0.25, .width = 6, .height = 1.5, .nx = 12, .ny = 5};
  std::vector<double> density, tdf, displacement;
  for (int i = 0; i < grid.nx; ++i)
    for (int j = 0; j < grid.ny; ++j) {
      const Vec2 p = grid.cell_center(i, j);
      density.push_back(p.x() + 100 * p.y());
    }
  for (int i = 0; i <= grid.nx; ++i)
    for (int j = 0; j <= grid.ny; ++j) {
      const Vec2 p = grid.node_position(i, j);
      tdf.push_back(p.x() * p.y());
      displacement.insert(displacement.end(), {2 * p.x(), -3 * p.y()});
    }
  write_image_data(scratch / "a.vti", grid, std::vector<Field>{{"density", density}},
                   std::vector<Field>{{"tdf", tdf}, {"displacement", displacement, 2}});
  vtkNew<vtkXMLImageDataReader> reader;
  read(reader, scratch / "a.vti");
  vtkImageData* image = reader->GetOutput();
  ASSERT_EQ(image->GetNumberOfCells(), grid.n_cells());
  ASSERT_EQ(image->GetNumberOfPoints(), grid.n_nodes());
  auto* cells = image->GetCellData()->GetArray("density");
  ASSERT_NE(cells, nullptr);
  EXPECT_EQ(cells->GetDataType(), VTK_FLOAT);
  for (int k = 0; k < grid.n_cells(); ++k) {
    double b[6];
    image->GetCellBounds(k, b);
    EXPECT_NEAR(cells->GetTuple1(k), 0.5 * (b[0] + b[1]) + 50 * (b[2] + b[3]), 200 * kFloat);
  }
  auto* point_tdf = image->GetPointData()->GetArray("tdf");
  auto* vectors = image->GetPointData()->GetArray("displacement");
  ASSERT_EQ(vectors->GetNumberOfComponents(), 3);
  for (int k = 0; k < grid.n_nodes(); ++k) {
    const double* p = image->GetPoint(k);
    EXPECT_NEAR(point_tdf->GetTuple1(k), p[0] * p[1], 10 * kFloat);
    EXPECT_NEAR(vectors->GetComponent(k, 0), 2 * p[0], 12 * kFloat);
    EXPECT_NEAR(vectors->GetComponent(k, 1), -3 * p[1], 6 * kFloat);
    EXPECT_EQ(vectors->GetComponent(k, 2), 0);
  }
}

// Rounding changes a value by at most half of the last bit that is kept, and makes files smaller.
TEST(ImageData, RoundsTheMantissa) {
  const Scratch scratch;
  const Grid grid{.nx = 100, .ny = 100};
  std::vector<double> values;
  for (int k = 0; k < grid.n_cells(); ++k)
    values.push_back(std::sin(0.7 * k) * std::exp(-1e-3 * k));
  const std::vector<Field> all = {{"v", values}},
                           ten = {{.name = "v", .values = values, .bits = 10}};
  write_image_data(scratch / "all.vti", grid, all, {});
  write_image_data(scratch / "ten.vti", grid, ten, {});
  vtkNew<vtkXMLImageDataReader> exact, coarse;
  read(exact, scratch / "all.vti");
  read(coarse, scratch / "ten.vti");
  for (int k = 0; k < grid.n_cells(); ++k) {
    const double value = exact->GetOutput()->GetCellData()->GetArray("v")->GetTuple1(k);
    EXPECT_NEAR(coarse->GetOutput()->GetCellData()->GetArray("v")->GetTuple1(k), value,
                std::ldexp(std::abs(value), -11));
  }
  EXPECT_LT(static_cast<double>(contents_of(scratch / "ten.vti").size()),
            0.75 * static_cast<double>(contents_of(scratch / "all.vti").size()));
}

// Field data belong to no cell or point, and may have any length.
TEST(ImageData, CarriesFieldsOfTheWholeDataSet) {
  const Scratch scratch;
  const Grid grid{.nx = 3, .ny = 2};
  const std::vector<double> components = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14};
  const std::vector<double> none, density(6, 0.5);
  const std::vector<Field> data = {{"components", components, 7}, {"none", none, 7}};
  write_image_data(scratch / "a.vti", grid, std::vector<Field>{{"density", density}}, {}, data);
  vtkNew<vtkXMLImageDataReader> reader;
  read(reader, scratch / "a.vti");
  vtkDataArray* found = reader->GetOutput()->GetFieldData()->GetArray("components");
  ASSERT_NE(found, nullptr);
  ASSERT_EQ(found->GetNumberOfComponents(), 7);
  ASSERT_EQ(found->GetNumberOfTuples(), 2);
  for (int k = 0; k < 14; ++k) EXPECT_EQ(found->GetComponent(k / 7, k % 7), components[size_t(k)]);
  EXPECT_EQ(reader->GetOutput()->GetCellData()->GetArray("density")->GetTuple1(5), 0.5);
}

TEST(QuadMeshFile, ReadsBackInPlaneAndSpace) {
  const Scratch scratch;
  for (const int dimension : {2, 3}) {
    QuadMesh mesh{dimension, {}, {{0, 1, 2, 3}, {1, 4, 5, 2}}};
    const double points[6][3] = {{0, 0, .1}, {1, 0, .2}, {1, 1, .3},
                                 {0, 1, .4}, {2, 0, .5}, {2, 1, .6}};
    for (const auto& p : points) mesh.points.insert(mesh.points.end(), p, p + dimension);
    const std::vector<double> energy = {7, 8}, velocity = {0, 1, 2, 3, 4, 5};
    write_quad_mesh(scratch / "a.vtu", mesh, std::vector<Field>{{"energy", energy}},
                    std::vector<Field>{{"v", velocity}});
    vtkNew<vtkXMLUnstructuredGridReader> reader;
    read(reader, scratch / "a.vtu");
    vtkUnstructuredGrid* grid = reader->GetOutput();
    ASSERT_EQ(grid->GetNumberOfCells(), 2);
    ASSERT_EQ(grid->GetNumberOfPoints(), 6);
    EXPECT_EQ(grid->GetCellType(1), VTK_QUAD);
    EXPECT_EQ(grid->GetCell(1)->GetPointId(2), 5);
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(grid->GetPoint(k)[1], points[k][1], kFloat);
      EXPECT_NEAR(grid->GetPoint(k)[2], dimension == 3 ? points[k][2] : 0, kFloat);
      EXPECT_EQ(grid->GetPointData()->GetArray("v")->GetTuple1(k), k);
    }
    EXPECT_EQ(grid->GetCellData()->GetArray("energy")->GetTuple1(1), 8);
  }
}

TEST(Outlines, CarryNumberAndParameters) {
  const Scratch scratch;
  std::vector<Component> components(3);
  for (int k = 0; k < 3; ++k) {
    components[k].center = {0.5 * k, 0.25};
    components[k].angle = 0.1 * k;
  }
  write_components(scratch / "c.vtp", components, 1e-3, 48);
  vtkNew<vtkXMLPolyDataReader> reader;
  read(reader, scratch / "c.vtp");
  vtkPolyData* poly = reader->GetOutput();
  ASSERT_EQ(poly->GetNumberOfCells(), 3);
  ASSERT_EQ(poly->GetNumberOfPoints(), 3 * 48);
  for (int k = 0; k < 3; ++k) {
    vtkCell* line = poly->GetCell(k);
    ASSERT_EQ(line->GetNumberOfPoints(), 49);
    EXPECT_EQ(line->GetPointId(0), line->GetPointId(48));  // closed
    const auto value = [&](const char* name) {
      return poly->GetCellData()->GetArray(name)->GetTuple1(k);
    };
    EXPECT_EQ(value("component"), k + 1);
    EXPECT_EQ(value("X0"), 0.5 * k);
    EXPECT_EQ(value("Y0"), 0.25);
    EXPECT_EQ(value("half_length"), 1);
    EXPECT_NEAR(value("angle"), 0.1 * k, kFloat);
    EXPECT_NEAR(value("c3"), 0.1, kFloat);
  }
  write_components(scratch / "none.vtp", {}, 1e-3);
  vtkNew<vtkXMLPolyDataReader> empty;
  read(empty, scratch / "none.vtp");
  EXPECT_EQ(empty->GetOutput()->GetNumberOfCells(), 0);
}

TEST(SeriesFile, IsCompleteAfterEveryFrame) {
  const Scratch scratch;
  const CommaLocale comma;
  std::filesystem::create_directories(scratch / "design");
  Series series(scratch / "design/iterations.pvd");
  EXPECT_FALSE(std::filesystem::exists(series.path()));
  const char* times[] = {"0", "1000.5", "2001"};
  for (int k = 0; k < 3; ++k) {
    series.add(1000.5 * k, "frame_" + std::to_string(k) + "&.vti");
    const auto root = vtkSmartPointer<vtkXMLDataElement>::Take(
        vtkXMLUtilities::ReadElementFromFile(series.path().c_str()));
    ASSERT_NE(root, nullptr);
    EXPECT_STREQ(root->GetAttribute("type"), "Collection");
    vtkXMLDataElement* list = root->GetNestedElement(0);
    ASSERT_EQ(list->GetNumberOfNestedElements(), k + 1);
    EXPECT_EQ(series.size(), k + 1);
    vtkXMLDataElement* last = list->GetNestedElement(k);
    EXPECT_STREQ(last->GetAttribute("file"), ("frame_" + std::to_string(k) + "&.vti").c_str());
    EXPECT_STREQ(last->GetAttribute("timestep"), times[k]);
  }
  EXPECT_FALSE(std::filesystem::exists(series.path() + ".tmp"));
}

TEST(SeriesFile, ForgetsDroppedFrames) {
  const Scratch scratch;
  Series series(scratch / "a.pvd");
  series.drop("last.vti");
  series.add(1, "last.vti");
  series.drop("last.vti");
  series.add(2, "last.vti");
  EXPECT_EQ(series.size(), 1);
  series.drop("last.vti");
  series.add(3, "third.vti");
  const std::string text = contents_of(scratch / "a.pvd");
  EXPECT_FALSE(contains(text, "last.vti"));
  EXPECT_TRUE(contains(text, "timestep=\"3\""));
  EXPECT_EQ(series.size(), 1);
}

TEST(Png, HasTheSizeAndStandsUpright) {
  const Scratch scratch;
  const Grid grid{.nx = 3, .ny = 2};
  std::vector<double> values(6, 0.0);
  values[grid.cell(0, 1)] = 1;  // top left
  write_png(scratch / "a.png", grid, values, {.pixels_per_cell = 5});
  vtkNew<vtkPNGReader> reader;
  read(reader, scratch / "a.png");
  vtkImageData* image = reader->GetOutput();
  EXPECT_EQ(image->GetDimensions()[0], 15);
  EXPECT_EQ(image->GetDimensions()[1], 10);
  EXPECT_EQ(image->GetNumberOfScalarComponents(), 1);
  // VTK also reads pictures with y up: row 9 is the top one.
  EXPECT_EQ(image->GetScalarComponentAsDouble(0, 9, 0, 0), 0);
  EXPECT_EQ(image->GetScalarComponentAsDouble(0, 0, 0, 0), 255);
  EXPECT_EQ(image->GetScalarComponentAsDouble(14, 9, 0, 0), 255);
}

TEST(VtkFiles, AreTheSameBytesTwice) {
  const Scratch scratch;
  const Grid grid{.nx = 40, .ny = 20};
  VectorXd values = VectorXd::LinSpaced(grid.n_cells(), 0, 1).array().sin();
  const std::vector<Field> fields = {{"density", {values.data(), size_t(values.size())}}};
  const std::vector<Component> components(4);
  for (const char* name : {"a", "b"}) {
    write_image_data(scratch / (name + std::string(".vti")), grid, fields, {});
    write_components(scratch / (name + std::string(".vtp")), components, 1e-3);
    write_png(scratch / (name + std::string(".png")), grid, fields[0].values);
  }
  for (const char* ending : {".vti", ".vtp", ".png"}) {
    const std::string first = contents_of(scratch / (std::string("a") + ending));
    EXPECT_GT(first.size(), 100u);
    EXPECT_EQ(first, contents_of(scratch / (std::string("b") + ending)));
  }
  const std::string text = contents_of(scratch / "a.vti");
  EXPECT_TRUE(contains(text, "format=\"binary\""));
  EXPECT_TRUE(contains(text, "vtkZLibDataCompressor"));
  EXPECT_FALSE(contains(text, "appended"));
}

// VTK writes ranges of fields as text in the locale of the process.
TEST(VtkFiles, AreTheSameBytesWithADecimalComma) {
  const Scratch scratch;
  const Grid grid{.x0 = -0.5, .width = 1.5, .height = 0.7, .nx = 2, .ny = 2};
  const std::vector<double> cells = {0.25, 1234.5, -0.125, 1e-7, 3, 4, 5, 6.5};
  const std::vector<Field> fields = {{"displacement", cells, 2}};
  const std::vector<std::vector<Vec2>> outlines = {{{0.5, 0.25}, {1.5, 0.25}, {1.5, 2.75}}};
  const QuadMesh mesh{2, {0.5, 0, 1.5, 0, 1.5, 1.25, 0.5, 1.25}, {{0, 1, 2, 3}}};
  const auto write = [&](const std::string& name) {
    write_image_data(scratch / name + ".vti", grid, fields, {});
    write_outlines(scratch / name + ".vtp", outlines, {});
    write_quad_mesh(scratch / name + ".vtu", mesh, {}, {});
  };
  write("point");
  const CommaLocale comma;
  write("comma");
  std::ostringstream text;
  text << 1234.5;
  EXPECT_EQ(text.str(), "1.234,5");  // the locale is unchanged
  for (const char* ending : {".vti", ".vtp", ".vtu"}) {
    EXPECT_TRUE(contains(contents_of(scratch / "point" + ending), "L2_NORM_RANGE")) << ending;
    EXPECT_TRUE(contents_of(scratch / "point" + ending) == contents_of(scratch / "comma" + ending))
        << ending;
  }
}

TEST(VtkFiles, RefuseWrongSizesAndNumbersThatAreNone) {
  const Scratch scratch;
  const Grid grid{.nx = 2, .ny = 2};
  const std::vector<double> four = {1, 2, std::nan(""), 4}, three = {1, 2, 3};
  const auto message = [&](const std::vector<double>& values) -> std::string {
    try {
      write_image_data(scratch / "a.vti", grid, std::vector<Field>{{"density", values}}, {});
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), Error::Kind::numerical);
      return e.what();
    }
    return "";
  };
  EXPECT_TRUE(says(message(four), scratch / "a.vti: ", {"'density'", "finite", "2"}));
  EXPECT_TRUE(says(message(three), scratch / "a.vti: ", {"'density'", "3 values", "4"}));
  EXPECT_FALSE(std::filesystem::exists(scratch / "a.vti"));
  EXPECT_THROW(write_png(scratch / "a.png", grid, four), Error);
  EXPECT_THROW(write_png(scratch / "a.png", grid, three), Error);
  EXPECT_THROW(write_png(scratch / "a.png", grid, three, {.lower = 1, .upper = 1}), Error);
}

}  // namespace
}  // namespace flexmorph::io
