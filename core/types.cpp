#include "core/types.h"

namespace touchline {

const char* describe(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kNotExamined:
      return "not the color of a patch";
    case Verdict::kTeamPatch:
      return "team patch";
    case Verdict::kIdentification:
      return "identification patch";
    case Verdict::kBall:
      return "ball";
    case Verdict::kFragment:
      return "fragment of a patch";
    case Verdict::kTooSmall:
      return "too small";
    case Verdict::kTooLarge:
      return "too large";
    case Verdict::kWrongShape:
      return "wrong shape";
    case Verdict::kOutsideField:
      return "outside the field";
    case Verdict::kTooClose:
      return "too close to a larger team patch";
    case Verdict::kNoPartner:
      return "no partner at the right distance";
    case Verdict::kPartnerTaken:
      return "partner belongs to a better match";
    case Verdict::kSurplus:
      return "more than the maximum number";
  }
  return "unknown";
}

bool is_refusal(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kNotExamined:
    case Verdict::kTeamPatch:
    case Verdict::kIdentification:
    case Verdict::kBall:
    case Verdict::kFragment:
      return false;
    default:
      return true;
  }
}

const char* describe(IdDoubt doubt) noexcept {
  switch (doubt) {
    case IdDoubt::kNone:
      return "";
    case IdDoubt::kNoIdentification:
      return "only its team patch is seen";
    case IdDoubt::kSeveralPoses:
      return "two poses are possible";
    case IdDoubt::kSeveralIds:
      return "two ids are possible";
    case IdDoubt::kUnknownColors:
      return "no robot has these colors";
    case IdDoubt::kInaccuratePlaces:
      return "its patches are not where a marker has them";
    case IdDoubt::kOtherOutline:
      return "its team patch has another outline";
    case IdDoubt::kOverload:
      return "an overload cut off a part of its patches";
  }
  return "unknown";
}

const char* describe(Stage stage) noexcept {
  switch (stage) {
    case Stage::kRegion:
      return "region";
    case Stage::kMarker:
      return "marker";
    case Stage::kTrack:
      return "track";
    case Stage::kControl:
      return "control";
    case Stage::kRadio:
      return "radio";
  }
  return "unknown";
}

}  // namespace touchline
