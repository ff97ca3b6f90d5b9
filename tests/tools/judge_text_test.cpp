// Verdicts and texts of touchline-devices --judge, and its command line.
#include "tools/programs/devices/judge/judge_text.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/command_output.h"

namespace touchline::devices {
namespace {

JudgeReport good_report() {
  JudgeReport report;
  report.requested.backend = hal::CameraBackend::kV4l2;
  report.requested.format = hal::CameraFormat::kYuyv;
  report.requested.rate_hz = 60.0;
  report.info = {PixelFormat::kYuyv, 640, 480, 60.0,
                 "/dev/video0 (HD Webcam, usb-1): yuyv 640x480 at 60 Hz, 4 buffers mapped, time stamps of the first "
                 "packet, exposure 5000 us"};
  report.timing = {.frames = 600,
                   .lost = 0,
                   .delivered_hz = 59.9,
                   .period_s = 1.0 / 60.0,
                   .jitter_s = 0.0003,
                   .worst_jitter_s = 0.001,
                   .delay_s = 0.02,
                   .worst_delay_s = 0.03,
                   .delay_spread_s = 0.001};
  report.still = {.brightness = 90.0, .noise = 1.5, .flicker = 0.003};
  report.exposures = {{100, 3.0, 60.0, ""}, {1000, 30.0, 60.0, ""}, {5000, 90.0, 60.0, ""}, {10000, 140.0, 60.0, ""}};
  report.shutter = {.measured = true, .readout_s = 0.0002, .sigma_s = 0.0003};
  return report;
}

void expect_verdict(const JudgeReport& report, const std::string& text) {
  EXPECT_NE(verdict(report).find(text), std::string::npos) << verdict(report);
}

TEST(JudgeVerdict, IsOneSentence) {
  JudgeReport report = good_report();
  EXPECT_EQ(verdict(report), "This camera is good for Touchline.");
  report.shutter.measured = false;
  EXPECT_EQ(verdict(report), "This camera is good for Touchline (its shutter was not measured).");
}

TEST(JudgeVerdict, NamesWhatIsNotGood) {
  JudgeReport report = good_report();
  report.shutter.readout_s = 0.016;
  EXPECT_EQ(verdict(report),
            "This camera is usable, but not good, because its shutter rolls: a robot at 1 m/s is displaced by 16 mm "
            "between the first and the last row.");
  report = good_report();
  report.timing.delivered_hz = 29.9;
  expect_verdict(report, "usable, but not good, because it delivers 29.9 frames a second, between which");
  report.timing.delivered_hz = 7.5;
  expect_verdict(report, "not usable, because it delivers 7.5 frames a second");
  report = good_report();
  report.timing.delivered_hz = 55.0;
  expect_verdict(report, "it delivers 55 of the requested 60 frames a second");
  report = good_report();
  report.timing.lost = 40;
  expect_verdict(report, "6.2 % of its frames are lost");
  report = good_report();
  report.timing.jitter_s = 0.004;
  expect_verdict(report, "its time stamps jitter by 4.0 ms");
  report = good_report();
  for (ExposureStep& step : report.exposures) step.brightness = 90.0;
  expect_verdict(report, "its exposure cannot be set");
  report = good_report();
  report.exposures[0].differs =
      "exposure_us = 100: the camera has driver-specific exposure steps, 0 to 255, instead of "
      "microseconds: set exposure_steps";
  for (ExposureStep& step : report.exposures) step.brightness = 90.0;
  expect_verdict(report, "because its exposure has steps of its own");
  report = good_report();
  report.exposures[2].rate_hz = 30.0;
  expect_verdict(report, "its rate falls to 30 Hz at an exposure of 5 ms");
  report = good_report();
  report.still.noise = 15.0;
  expect_verdict(report, "not usable, because a pixel's noise is 15.0 of 255");
  report = good_report();
  report.still.flicker = 0.05;
  report.still.has_bands = true;
  expect_verdict(report, "the light flickers by 5.0 % in bands: set camera.power_line");
}

TEST(JudgeVerdict, GivesOnlyTheReasonsOfTheWorstGrade) {
  JudgeReport report = good_report();
  report.shutter.readout_s = 0.016;
  report.timing.delivered_hz = 7.5;
  EXPECT_EQ(verdict(report).find("its shutter rolls"), std::string::npos);
  EXPECT_EQ(judge_findings(report).size(), 2u);
}

TEST(JudgeReportText, HasTheFieldsOfTheFormInTheDocumentation) {
  std::ostringstream read;
  read << std::ifstream(TOUCHLINE_DOCS "/hardware.md").rdbuf();
  const std::string text = hardware_report(good_report(), "Some Board, Debian", "1.2.3");
  std::istringstream form(read.str().substr(read.str().find("\n```\n") + 5));
  std::string line;
  int fields = 0;
  while (std::getline(form, line) && line != "```") {
    EXPECT_NE(text.find(line.substr(0, line.find(':') + 1)), std::string::npos) << line;
    ++fields;
  }
  EXPECT_GE(fields, 5);
  EXPECT_NE(text.find("/dev/video0 (HD Webcam, usb-1)"), std::string::npos) << text;
  EXPECT_NE(text.find("time stamps   of the first packet, monotonic"), std::string::npos) << text;
}

TEST(JudgeProgram, JudgesTheArena) {
  const std::string command = std::string(TOUCHLINE_DEVICES " --judge --no-motion --board ") + TOUCHLINE_MOCK_BOARD +
                              " --mode yuyv,64x48,30 --set arena.camera.focal_px=56 2>&1";
  const auto [code, output] = touchline::testing::run_command(command);
  EXPECT_EQ(code, 0) << output;
  EXPECT_NE(output.find("1/3 keep the picture still"), std::string::npos) << output;
  EXPECT_NE(output.find("This camera is usable, but not good, because it delivers 30 frames a second"),
            std::string::npos)
      << output;
}

TEST(JudgeProgram, NamesWhatIsWrong) {
  const auto expect_error = [](const std::string& options, int expected, const std::string& message) {
    const auto [code, output] = touchline::testing::run_command(TOUCHLINE_DEVICES " " + options + " 2>&1");
    EXPECT_EQ(code, expected) << output;
    EXPECT_NE(output.find(message), std::string::npos) << output;
  };
  expect_error("--judge /dev/video77", 2, "/dev/video77: no such camera; here: ");
  expect_error("--judge no-such-id", 2, "no-such-id: no such camera, or several; libcamera has: ");
  expect_error("--judge --board /nowhere.toml", 1, "/nowhere.toml");
  expect_error(std::string("--judge --mode yuyv --board ") + TOUCHLINE_MOCK_BOARD, 1,
               "is not FORMAT,WIDTHxHEIGHT,RATE");
  expect_error("--mode yuyv,64x48,30", 64, "--mode requires --judge");
  expect_error("--lens 5", 64, "is not WIDTHxHEIGHT,COLUMNS");
}

}  // namespace
}  // namespace touchline::devices
