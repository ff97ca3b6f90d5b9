#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "firmware/console/web_server_parts.h"

namespace touchline::console {
namespace {

// A page asks for one answer after the other, and for a file beside it; further requests would only wait for the disk.
constexpr std::ptrdiff_t kMaxWaiting = 6;
// Part of a file that is read and sent at once: a part waits for the next turn of the server, so this bounds the rate
// of a download to 30 MB/s, and its memory.
constexpr std::uint64_t kPartBytes = std::uint64_t{256} * 1024;

unsigned status_of(ErrorCode code) {
  if (code == ErrorCode::kNotFound) return HTTP_STATUS_NOT_FOUND;
  if (code == ErrorCode::kOutOfRange) return HTTP_STATUS_BAD_REQUEST;
  return HTTP_STATUS_INTERNAL_SERVER_ERROR;
}

/// Returns the number behind "from=" in the request's address; `missing` if there is none.
std::uint64_t number_of(lws* connection, const char* name, std::uint64_t missing) {
  std::array<char, 24> text{};
  const char* const value = lws_get_urlarg_by_name(connection, name, text.data(), static_cast<int>(text.size()));
  if (value == nullptr) return missing;
  std::uint64_t number = missing;
  std::from_chars(value, value + std::strlen(value), number);
  return number;
}

}  // namespace

int WebServer::Implementation::begin_recordings(lws* connection, std::string_view path) {
  if (!hub_.recordings() && path == "/recordings") {
    return answer(connection, HTTP_STATUS_OK, "application/json", R"({"folder":null,"recordings":[]})");
  }
  if (!hub_.recordings()) {
    return answer(connection, HTTP_STATUS_NOT_FOUND, kPlainText,
                  "There is no folder for recordings: set recording.folder in the board file.\n");
  }
  const auto waiting = std::count_if(requests_.begin(), requests_.end(), [](const auto& entry) {
    return entry.second.kind == HttpRequest::Kind::kRecording;
  });
  if (waiting >= kMaxWaiting) {
    return answer(connection, HTTP_STATUS_SERVICE_UNAVAILABLE, kPlainText, "Too many recordings are being read.\n");
  }
  constexpr std::string_view kBase = "/recordings";
  path.remove_prefix(std::min(kBase.size() + 1, path.size()));
  const std::size_t slash = path.find('/');
  const std::string name(path.substr(0, slash));
  const std::string_view part = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  if (!part.empty() && part != "frames" && part != "file") {
    return answer(connection, HTTP_STATUS_NOT_FOUND, kPlainText, "There is no such page.\n");
  }
  const FrameRange range{number_of(connection, "from=", 0), number_of(connection, "count=", 1),
                         number_of(connection, "step=", 1)};
  lws_set_timeout(connection, NO_PENDING_TIMEOUT, 0);  // no timeout, because the disk may be slow
  HttpRequest& request = requests_[connection];
  request = {};
  request.kind = HttpRequest::Kind::kRecording;
  request.is_made = true;
  request.type = part == "frames" ? "application/octet-stream" : "application/json";
  if (part == "file") {
    request.name = name;
    request.type = "application/octet-stream";
    make_recording(connection, request, [name](Recordings& recordings) -> Result<std::string> {
      TOUCHLINE_TRY_ASSIGN(const std::uint64_t size, recordings.size(name));
      return std::to_string(size);
    });
  } else if (part == "frames") {
    make_recording(connection, request,
                   [name, range](Recordings& recordings) { return recordings.frames(name, range); });
  } else if (name.empty()) {
    make_recording(connection, request, [](Recordings& recordings) { return recordings.list(); });
  } else {
    make_recording(connection, request, [name](Recordings& recordings) { return recordings.describe(name); });
  }
  schedule(Duration::zero());
  return 0;
}

void WebServer::Implementation::make_recording(lws* connection, HttpRequest& request,
                                               std::function<Result<std::string>(Recordings& recordings)> make) {
  request.made.reset();
  request.body.clear();
  request.job = ++last_job_;
  hub_.recordings_thread().run([this, connection, job = request.job, make = std::move(make),
                                recordings = hub_.recordings()]() -> FileThread::Finish {
    auto made = std::make_shared<Result<std::string>>(failure(ErrorCode::kFull, "memory is too short"));
    try {
      *made = make(*recordings);
    } catch (const std::exception& error) {  // out of memory
    }
    return [this, connection, job, made] {
      // The connection may have ended, or belong to another request.
      const auto found = requests_.find(connection);
      if (found != requests_.end() && found->second.job == job) found->second.made = std::move(*made);
    };
  });
}

int WebServer::Implementation::write_recording(lws* connection, HttpRequest& request) {
  if (!request.made) return 0;
  const Result<std::string> made = *std::exchange(request.made, std::nullopt);
  const bool is_begun = request.offset > 0 || request.size > 0;
  if (!made.ok() && is_begun) return -1;
  if (!made.ok()) return answer(connection, status_of(made.code()), kPlainText, made.text() + "\n");
  if (request.name.empty()) return answer(connection, HTTP_STATUS_OK, request.type, made.value());
  if (!is_begun) return begin_file(connection, request, std::stoull(made.value()));
  // Somebody has cut the file.
  if (made.value().empty()) return -1;
  const std::uint64_t left = request.size - request.offset;
  std::string part(LWS_PRE, '\0');
  part.append(made.value(), 0, static_cast<std::size_t>(std::min<std::uint64_t>(left, made.value().size())));
  const std::size_t bytes = part.size() - LWS_PRE;
  request.offset += bytes;
  const bool is_last = request.offset == request.size;
  if (lws_write(connection, reinterpret_cast<unsigned char*>(part.data()) + LWS_PRE, bytes,
                is_last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0) {
    return -1;
  }
  if (is_last) {
    requests_.erase(connection);
    return complete(connection);
  }
  make_recording(connection, request, [name = request.name, offset = request.offset](Recordings& recordings) {
    return recordings.read(name, offset, kPartBytes);
  });
  return 0;
}

// Answers with the headers of a file, which is sent in parts.
int WebServer::Implementation::begin_file(lws* connection, HttpRequest& request, std::uint64_t size) {
  // A name of a recording has no line break; a quotation mark would end the header's value.
  std::string name = request.name;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '"' || c == '\\' || c < ' '; }, '_');
  const std::string disposition = "attachment; filename=\"" + name + "\"";
  if (size == 0) return answer(connection, HTTP_STATUS_OK, request.type, {});
  if (!write_headers(connection, HTTP_STATUS_OK, request.type, size,
                     {.name = "content-disposition:", .value = disposition})) {
    return -1;
  }
  request.size = size;
  make_recording(connection, request,
                 [name = request.name](Recordings& recordings) { return recordings.read(name, 0, kPartBytes); });
  return 0;
}

}  // namespace touchline::console
