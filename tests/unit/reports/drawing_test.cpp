// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "datasets/io/image_io.h"
#include "reports/drawing/drawing.h"
#include "reports/drawing/name_spans.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::report {
namespace {

const Drawing kDrawing{
    40.0,
    20.0,
    {Polyline{{{0.0, 10.0}, {40.0, 10.0}}, {255, 0, 0}, 4.0}, Disc{{20.0, 10.0}, 5.0, {0, 0, 255}},
     Label{{20.0, 5.0}, "a < b & c", 4.0, Anchor::kMiddle, {0, 0, 0}}}};

TEST(SvgText, ContainsEveryMarkAndEscapesText) {
  const std::string svg = svg_text(kDrawing);
  EXPECT_NE(svg.find("viewBox=\"0 0 40.00 20.00\""), std::string::npos);
  EXPECT_NE(svg.find("stroke=\"#ff0000\" stroke-width=\"4.00\" points=\"0.00,10.00 40.00,10.00\""),
            std::string::npos);
  EXPECT_NE(svg.find("<circle cx=\"20.00\" cy=\"10.00\" r=\"5.00\" fill=\"#0000ff\"/>"), std::string::npos);
  EXPECT_NE(svg.find("text-anchor=\"middle\" fill=\"#000000\">a &lt; b &amp; c</text>"), std::string::npos);
}

TEST(SvgText, HasDashesAndTextThatRunsUpwards) {
  const Drawing drawing{.width = 10.0,
                        .height = 10.0,
                        .marks = {Polyline{{{0.0, 0.0}, {9.0, 9.0}}, {}, 1.0, {3.5, 2.0}},
                                  Label{{2.0, 5.0}, "up", 4.0, Anchor::kMiddle, {}, true}}};
  const std::string svg = svg_text(drawing);
  EXPECT_NE(svg.find("stroke-dasharray=\"3.5 2\""), std::string::npos);
  EXPECT_NE(svg.find("transform=\"rotate(-90 2.00 5.00)\">up</text>"), std::string::npos);
}

// Two pixels, black and orange, over 20 x 10 units.
TEST(Rasters, AreDrawnInAllFormats) {
  const Drawing drawing{
      .width = 20.0, .height = 10.0, .marks = {Raster{{0.0, 0.0}, {20.0, 10.0}, 2, {0, 0, 0, 255, 128, 64}}}};
  EXPECT_NE(svg_text(drawing).find("<image x=\"0.00\" y=\"0.00\" width=\"20.00\" height=\"10.00\""),
            std::string::npos);
  EXPECT_NE(svg_text(drawing).find("base64,iVBORw0KGgo"), std::string::npos);  // the signature of PNG
  const cv::Mat image = datasets::decode_image(png_bytes(drawing, 1.0), "raster");
  EXPECT_EQ(image.at<cv::Vec3b>(5, 9), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(image.at<cv::Vec3b>(5, 10), cv::Vec3b(255, 128, 64));
  EXPECT_NE(pdf_text({&drawing, 1}).find("/Image"), std::string::npos);
  const std::array<Drawing, 2> two{drawing, drawing};
  EXPECT_EQ(std::get<Raster>(stacked(two).marks[1]).bottom_right.y, 20.0);
}

/// Spans as text: "_" or "^" before a lowered or raised one, "'" before a smaller one.
std::string spans_text(const std::string& name) {
  std::string text;
  for (const NameSpan& span : name_spans(name)) {
    text += span.rise < 0.0 ? "[_" : span.rise > 0.0 ? "[^" : span.scale < 1.0 ? "['" : "[";
    text += span.text + "]";
  }
  return text;
}

TEST(NameSpans, DrawIndicesExponentsGreekLettersAndSmallCapitals) {
  EXPECT_EQ(spans_text("$x_1$ and $y^{ij}$"), "[x][_1][ and y][^ij]");
  EXPECT_EQ(spans_text("$\\alpha = -2 \\times \\Sigma_k$"), "[α=−2×Σ][_k]");
  EXPECT_EQ(spans_text("\\textsc{Orb} a\\_b \\& c"), "[O]['RB][ a_b & c]");
  EXPECT_EQ(spans_text("$v_\\text{max}$"), "[v][_max]");
  EXPECT_EQ(spans_text("$x_é\u2009y^αβ$ é"), "[x][_é][\u2009y][^α][β é]");
}

TEST(NameSpans, KeepAnythingElse) {
  for (const char* name :
       {"a_b^c", "5 $ each", "$x", "\\foo{x}", "C:\\data", "$x_$", "\\textsc{x", "a}$x$", "{a}"})
    EXPECT_EQ(spans_text(name), std::string("[") + name + "]");
  const std::string deep = "$" + std::string(100, '{') + std::string(100, '}') + "$";
  EXPECT_EQ(spans_text(deep), "[" + deep + "]");
}

TEST(SvgText, PlacesTheSpansOfANameOneAfterTheOther) {
  Drawing drawing{.width = 100.0, .height = 20.0, .marks = {}};
  drawing.marks.push_back(Label{{50.0, 10.0}, "$x_1$", 10.0, Anchor::kRight, {}});
  const double x = text_width("x", 10.0);
  const double index = text_width("1", 7.0);
  EXPECT_DOUBLE_EQ(text_width("$x_1$", 10.0), x + index);
  const std::string svg = svg_text(drawing);
  EXPECT_NE(svg.find(fmt::format("<text x=\"{:.2f}\" y=\"10.00\" font-size=\"10.00\"", 50.0 - x - index)),
            svg.npos)
      << svg;
  EXPECT_NE(svg.find(fmt::format("<text x=\"{:.2f}\" y=\"11.50\" font-size=\"7.00\"", 50.0 - index)),
            svg.npos)
      << svg;
}

TEST(PdfText, HasAPageOfTheSizeOfEachDrawing) {
  const std::vector<Drawing> drawings{kDrawing, {.width = 30.0, .height = 50.0, .marks = {}}};
  const std::string pdf = pdf_text(drawings);
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_TRUE(pdf.ends_with("%%EOF\n"));
  EXPECT_NE(pdf.find("/MediaBox [ 0 0 40 20 ]"), std::string::npos);
  EXPECT_NE(pdf.find("/MediaBox [ 0 0 30 50 ]"), std::string::npos);
  EXPECT_NE(pdf.find("/Count 2"), std::string::npos);
  EXPECT_EQ(pdf, pdf_text(drawings));
}

TEST(PdfText, EmbedsItsFonts) {
  const std::string pdf = pdf_text({{kDrawing}});
  EXPECT_NE(pdf.find("/FontDescriptor"), std::string::npos);
  EXPECT_NE(pdf.find("/FontFile"), std::string::npos);
}

TEST(PngBytes, DrawsMarksAtTheirPositions) {
  const TemporaryFolder folder;
  const cv::Mat image = datasets::read_image(folder.write("drawing.png", png_bytes(kDrawing, 2.0)));
  ASSERT_EQ(image.cols, 80);  // 40 units at 2 px
  ASSERT_EQ(image.rows, 40);
  EXPECT_EQ(image.at<cv::Vec3b>(20, 40), cv::Vec3b(0, 0, 255));      // the disc is drawn over the line
  EXPECT_EQ(image.at<cv::Vec3b>(20, 70), cv::Vec3b(255, 0, 0));      // the line next to the disc
  EXPECT_EQ(image.at<cv::Vec3b>(38, 70), cv::Vec3b(255, 255, 255));  // background
}

TEST(PngBytes, RefusesAnImageThatIsTooLarge) {
  expect_input_error([] { static_cast<void>(png_bytes(kDrawing, 1000.0)); }, {"PNG", "40000 x 20000 pixels"});
}

TEST(TextWidth, GrowsWithTheTextAndTheSize) {
  EXPECT_GT(text_width("0.25", 8.0), text_width("0.2", 8.0));
  EXPECT_NEAR(text_width("0.25", 16.0), 2.0 * text_width("0.25", 8.0), 0.1);
}

TEST(HtmlText, HasAnSvgPerDrawing) {
  const std::string html = html_text(std::vector<Drawing>{kDrawing, kDrawing});
  EXPECT_TRUE(html.starts_with("<!doctype html>"));
  const std::size_t first = html.find("<svg");
  EXPECT_NE(html.find("<svg", first + 1), std::string::npos);
}

TEST(Stacked, PutsDrawingsBelowEachOther) {
  const Drawing all = stacked(std::vector<Drawing>{kDrawing, kDrawing});
  EXPECT_EQ(all.height, 40.0);
  EXPECT_EQ(std::get<Disc>(all.marks.at(4)).center.y, 30.0);  // 10 in the second drawing
}

}  // namespace
}  // namespace stillpoint::report
