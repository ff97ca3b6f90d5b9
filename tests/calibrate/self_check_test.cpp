#include "tools/programs/calibrate/colors/self_check.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <string>
#include <vector>

namespace touchline::calibrate {
namespace {

CheckedPicture seen_in(const std::string& image, const std::set<std::string>& explained) {
  CheckedPicture picture;
  picture.image = image;
  picture.visible = explained.size();
  picture.explained = explained;
  picture.ball = true;
  return picture;
}

SelfCheck check_of(const std::vector<CheckedPicture>& pictures) {
  return {{"own 0", "own 1", "opponent 0", "opponent 1"}, true, pictures, {}};
}

TEST(SelfCheck, PassesIfEveryRobotIsInSomePicture) {
  const SelfCheck check =
      check_of({seen_in("a.png", {"own 0", "own 1", "opponent 0"}), seen_in("b.png", {"own 0", "opponent 1"})});
  EXPECT_TRUE(check.passed());
  EXPECT_EQ(check.text(),
            "a.png: 3 of 3 visible robots explained\n"
            "b.png: 2 of 2 visible robots explained\n"
            "self-check: 4 of 4 robots explained; ball in 2 of 2 pictures\n");
}

TEST(SelfCheck, NamesRobotsThatAreInNoPicture) {
  const SelfCheck check = check_of({seen_in("a.png", {"own 0"}), seen_in("b.png", {"own 1"})});
  EXPECT_FALSE(check.passed());
  EXPECT_EQ(check.missing(), (std::vector<std::string>{"opponent 0", "opponent 1"}));
  EXPECT_EQ(check.absent(), "opponent 0, 1");
  CheckedPicture unclear = seen_in("c.png", {"own 1"});
  unclear.visible = 2;
  EXPECT_EQ(check_of({unclear}).absent(), "") << "one of the missing robots may be the one without id";
  EXPECT_NE(check.text().find("self-check: 2 of 4 robots explained; missing: opponent 0, 1; ball in 2 of 2 pictures"),
            std::string::npos)
      << check.text();
}

TEST(SelfCheck, LetsARobotInGlareStayUnknown) {
  const std::set<std::string> all = {"own 0", "own 1", "opponent 0", "opponent 1"};
  CheckedPicture glare = seen_in("c.png", {"own 0"});
  glare.visible = 2;
  glare.unknown = 1;
  EXPECT_TRUE(check_of({seen_in("a.png", all), seen_in("b.png", all), glare}).passed()) << "nine of ten";
  EXPECT_FALSE(
      check_of({seen_in("a.png", all), seen_in("b.png", {"own 1", "opponent 0", "opponent 1"}), glare}).passed())
      << "eight of nine";
}

// Each defect of one picture is enough to fail, even if all robots are explained in another one.
TEST(SelfCheck, FailsForEachVisibleRobotThatIsNotExplained) {
  const CheckedPicture all = seen_in("a.png", {"own 0", "own 1", "opponent 0", "opponent 1"});
  ASSERT_TRUE(check_of({all}).passed());
  const auto expect = [&](const char* text, const std::function<void(CheckedPicture&)>& change) {
    CheckedPicture other = seen_in("b.png", {"own 0"});
    change(other);
    const SelfCheck check = check_of({all, other});
    EXPECT_FALSE(check.passed()) << text;
    EXPECT_NE(check.text().find(std::string("b.png: ") + text + "\n"), std::string::npos) << check.text();
    EXPECT_NE(check.text().find("4 of 4 robots explained"), std::string::npos) << check.text();
  };
  expect("1 of 2 visible robots explained; without id: 1", [](CheckedPicture& p) {
    p.visible = 2;
    p.unknown = 1;
  });
  expect("1 of 2 visible robots explained; missing: own 1", [](CheckedPicture& p) {
    p.visible = 2;
    p.missing = {"own 1"};
  });
  expect("1 of 2 visible robots explained; wrong: own 1 where opponent 0 is", [](CheckedPicture& p) {
    p.visible = 2;
    p.wrong = {"own 1 where opponent 0 is"};
  });
  expect("1 of 3 visible robots explained; not seen: 2", [](CheckedPicture& p) {
    p.visible = 3;
    p.unseen = 2;
  });
  expect("1 of 1 visible robots explained; ball not recognized", [](CheckedPicture& p) {
    p.ball = false;
    p.ball_missing = true;
  });
}

TEST(SelfCheck, TellsHowManyRobotsTheTeamFileDoesNotList) {
  CheckedPicture other = seen_in("b.png", {"own 0"});
  other.unlisted = 1;
  const SelfCheck check = check_of({seen_in("a.png", {"own 0", "own 1", "opponent 0", "opponent 1"}), other});
  EXPECT_TRUE(check.passed());
  EXPECT_NE(check.text().find("b.png: 1 of 1 visible robots explained; not in the team file: 1\n"), std::string::npos)
      << check.text();
}

TEST(SelfCheck, FailsIfALittleOtherLightLosesRobots) {
  SelfCheck check = check_of({seen_in("a.png", {"own 0", "own 1", "opponent 0", "opponent 1"})});
  check.other_light = {{"5 % brighter", 3}, {"5 % darker", 4}};
  EXPECT_TRUE(check.passed()) << "one of four may stand at the edge of a lamp";
  EXPECT_EQ(check.fragile_in(), nullptr);
  EXPECT_NE(check.text().find("of 4 robots in the pictures: 3 5 % brighter, 4 5 % darker\n"), std::string::npos)
      << check.text();
  check.other_light[1].robots = 2;
  EXPECT_FALSE(check.passed());
  ASSERT_NE(check.fragile_in(), nullptr);
  EXPECT_EQ(check.fragile_in()->light, "5 % darker");
}

TEST(SelfCheck, NeedsTheBallInOnePicture) {
  CheckedPicture without = seen_in("a.png", {"own 0", "own 1", "opponent 0", "opponent 1"});
  without.ball = false;
  EXPECT_FALSE(check_of({without}).passed());
  EXPECT_EQ(check_of({without}).absent(), "") << "something else is missing";
  const SelfCheck check = check_of({without, seen_in("b.png", {"own 0"})});
  EXPECT_TRUE(check.passed());
  EXPECT_NE(check.text().find("a.png: 4 of 4 visible robots explained; no ball\n"), std::string::npos) << check.text();
}

}  // namespace
}  // namespace touchline::calibrate
