#include "firmware/recording/pipeline_state.h"

#include "firmware/recording/state_fields.h"

namespace touchline::recording {

void write_state(const Pipeline& pipeline, StateBytes& out) {
  out.clear();
  ArchiveWriter archive(out);
  archive(pipeline);
}

Result<void> read_state(std::span<const std::byte> bytes, Pipeline& pipeline) {
  ArchiveReader archive(bytes, Numbers::kSound);
  archive(pipeline);
  if (archive.ok() && archive.rest().empty()) return {};
  return failure(ErrorCode::kCorruptFrame, "the state of the filters and the play cannot be read");
}

}  // namespace touchline::recording
