#include "io/sheet.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "geometry/base.h"
#include "io/files.h"
#include "io/tables.h"

namespace flexmorph::io {
namespace {

constexpr double kColumn = 420, kGap = 24, kTitle = 26, kHead = 48;

/// An SVG page, separated into its view box, attributes and contents.
struct Page {
  std::array<double, 4> box{};  // x, y, width, height
  std::string attributes;       // attributes of the root without position and size
  std::string contents;

  explicit Page(const std::string& svg) {
    const size_t root = svg.find("<svg"), end = svg.find('>', root), last = svg.rfind("</svg>");
    const std::string head = svg.substr(root, end - root);
    const std::string view = attribute(head, "viewBox");
    std::istringstream numbers(view);
    numbers.imbue(std::locale::classic());
    for (double& each : box) numbers >> each;
    if (view.empty() || !numbers || !(box[2] > 0) || !(box[3] > 0))
      throw Error::input("contact sheet: a picture has no viewBox");
    for (const char* kept : {"font-family", "font-size", "fill"}) {
      const std::string value = attribute(head, kept);
      if (!value.empty())
        attributes.append(" ").append(kept).append("=\"").append(value).append("\"");
    }
    contents = svg.substr(end + 1, last - end - 1);
  }

  double height() const { return kColumn * box[3] / box[2]; }

  std::string placed(double x, double y) const {
    std::string view;
    for (const double each : box) {
      if (!view.empty()) view += " ";
      view += to_text(each);
    }
    return "<svg x=\"" + to_text(x) + "\" y=\"" + to_text(y) + "\" width=\"" + to_text(kColumn) +
           "\" height=\"" + to_text(height(), 6) + "\" viewBox=\"" + view + "\"" + attributes +
           ">" + contents + "</svg>\n";
  }

 private:
  static std::string attribute(const std::string& head, const std::string& name) {
    const size_t at = head.find(" " + name + "=\"");
    if (at == std::string::npos) return {};
    const size_t begin = at + name.size() + 3;
    return head.substr(begin, head.find('"', begin) - begin);
  }
};

/// Returns the font size [px] at which a title is at most as wide as a column. Bold letters of
/// common fonts have a mean width of 0.65 times the font size.
int fitting(const std::string& title) {
  constexpr double kMaxFontSize = 14, kMinFontSize = 7, kLetter = 0.65;
  const double size = kColumn / (kLetter * static_cast<double>(std::max<size_t>(1, title.size())));
  return static_cast<int>(std::clamp(size, kMinFontSize, kMaxFontSize));
}

std::string words(double x, double y, const std::string& content, int size) {
  return "<text x=\"" + to_text(x) + "\" y=\"" + to_text(y) + "\" font-size=\"" + to_text(size) +
         "\" font-weight=\"bold\">" + xml_escaped(content) + "</text>\n";
}

}  // namespace

std::string contact_sheet(const std::string& title, std::span<const SheetEntry> entries,
                          int columns) {
  const auto n = static_cast<size_t>(std::max(1, columns));
  std::string body;
  double top = kHead;
  for (size_t first = 0; first < entries.size(); first += n) {
    double lowest = top;
    for (size_t k = first; k < std::min(first + n, entries.size()); ++k) {
      const double x = kGap + static_cast<double>(k - first) * (kColumn + kGap);
      body += words(x, top + 17, entries[k].title, fitting(entries[k].title));
      double y = top + kTitle;
      for (const std::string& picture : entries[k].pictures) {
        const Page page(picture);
        body += page.placed(x, y);
        y += page.height() + 6;
      }
      lowest = std::max(lowest, y);
    }
    top = lowest + kGap;
  }
  const double width =
      kGap +
      static_cast<double>(std::min(n, std::max<size_t>(1, entries.size()))) * (kColumn + kGap);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + to_text(width) + " " +
         to_text(top) + "\" width=\"" + to_text(width) + "\" height=\"" + to_text(top) +
         "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" fill=\"#222\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n" +
         words(kGap, 30, title, 18) + body + "</svg>\n";
}

}  // namespace flexmorph::io
