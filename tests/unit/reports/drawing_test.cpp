// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "datasets/io/image_io.h"
#include "reports/drawing/drawing.h"
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

TEST(PdfText, IsOnePageOfTheSizeOfTheDrawing) {
  const std::string pdf = pdf_text(kDrawing);
  EXPECT_TRUE(pdf.starts_with("%PDF-"));
  EXPECT_TRUE(pdf.ends_with("%%EOF\n"));
  EXPECT_NE(pdf.find("/MediaBox [ 0 0 40 20 ]"), std::string::npos);
  EXPECT_NE(pdf.find("/Count 1"), std::string::npos);
  EXPECT_EQ(pdf, pdf_text(kDrawing));
}

TEST(WriteDrawingPng, DrawsMarksAtTheirPositions) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "drawing.png";
  write_drawing_png(file, kDrawing, 2.0);
  const cv::Mat image = datasets::read_image(file);
  ASSERT_EQ(image.cols, 80);  // 40 units at 2 px
  ASSERT_EQ(image.rows, 40);
  EXPECT_EQ(image.at<cv::Vec3b>(20, 40), cv::Vec3b(0, 0, 255));      // the disc is drawn over the line
  EXPECT_EQ(image.at<cv::Vec3b>(20, 70), cv::Vec3b(255, 0, 0));      // the line next to the disc
  EXPECT_EQ(image.at<cv::Vec3b>(38, 70), cv::Vec3b(255, 255, 255));  // background
}

}  // namespace
}  // namespace stillpoint::report
