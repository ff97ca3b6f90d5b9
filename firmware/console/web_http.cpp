#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

#include "firmware/console/bug_report.h"
#include "firmware/console/device_answer.h"
#include "firmware/console/web_server_parts.h"

namespace touchline::console {
namespace {

using namespace std::chrono_literals;

constexpr const char* kHtml = "text/html; charset=utf-8";
// Longest wait for a picture; after that, none is shown.
constexpr Duration kPictureWait = 3s;
// Maximum number of picture streams, each of which costs as much as a WebSocket with pictures.
constexpr std::ptrdiff_t kMaxStreams = 4;
constexpr std::size_t kHeaderRoom = 2048;
// Size of the parts of a body. A client that reads one part within the server's time limit is kept.
constexpr std::size_t kBodyPart = std::size_t{32} * 1024;

// Buffer for the headers of an answer, which libwebsockets fills.
struct HeaderBuffer {
  std::array<unsigned char, LWS_PRE + kHeaderRoom> bytes{};
  unsigned char* begin = bytes.data() + LWS_PRE;
  unsigned char* next = begin;
  unsigned char* end = bytes.data() + bytes.size();
};

}  // namespace

int WebServer::Implementation::on_http(lws* connection, lws_callback_reasons reason, void* in) {
  switch (reason) {
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
      admit(connection);
      return 0;
    case LWS_CALLBACK_HTTP:
      if (const auto visitor = visitors_.find(connection); visitor != visitors_.end()) {
        visitor->second.since = hal::MonotonicClock::read();
      }
      return begin_request(connection, static_cast<const char*>(in));
    case LWS_CALLBACK_HTTP_WRITEABLE:
      waiting_.erase(connection);
      return write_request(connection);
    case LWS_CALLBACK_CLOSED_HTTP:
    case LWS_CALLBACK_WSI_DESTROY:
      forget(connection);
      return 0;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:  // a WebSocket without our subprotocol
      return -1;
    default:
      return 0;
  }
}

int WebServer::Implementation::begin_request(lws* connection, std::string_view path) {
  // HEAD must work, because a page uses it to find out why its connection was refused.
  const bool is_head = lws_hdr_total_length(connection, WSI_TOKEN_HEAD_URI) > 0;
  if (!is_head && lws_hdr_total_length(connection, WSI_TOKEN_GET_URI) == 0) {
    return answer(connection, HTTP_STATUS_METHOD_NOT_ALLOWED, kPlainText, "Only GET and HEAD are possible.\n");
  }
  const bool is_page = path == "/", is_login = path == "/login";
  const std::optional<Refusal> refusal =
      check(connection, is_page || is_login ? Purpose::kNavigation : Purpose::kConsole);
  const bool may_login = is_login && refusal && refusal->status == HTTP_STATUS_UNAUTHORIZED;
  const bool is_refused = refusal && !may_login;
  if (is_head) return answer(connection, is_refused ? refusal->status : unsigned{HTTP_STATUS_OK}, kPlainText, {});
  if (is_refused) return answer(connection, refusal->status, kPlainText, refusal->text);
  if (is_login) return login(connection);
  if (path == "/snapshot.jpg") return begin_pictures(connection, HttpRequest::Kind::kSnapshot);
  if (path == "/stream.mjpg") return begin_pictures(connection, HttpRequest::Kind::kStream);
  if (path == "/bug-report") return begin_bug_report(connection);
  if (path == "/devices") {
    return begin_devices(connection, [camera = hub_.board().camera, priority = hub_.board().realtime.priority] {
      return device_answer(camera, priority);
    });
  }
  if (path == "/ports") return begin_devices(connection, port_answer);
  if (path == "/recordings" || path.starts_with("/recordings/")) return begin_recordings(connection, path);
  if (path == "/metrics") return answer(connection, HTTP_STATUS_OK, "text/plain; version=0.0.4", hub_.metrics());
  if (is_page) read_files_again();
  const PageFile* const file = files_->find(path);
  if (file != nullptr) return serve_page(connection, *file, path.starts_with("/assets/"));
  if (is_page) return answer(connection, HTTP_STATUS_OK, kHtml, missing_page());
  return answer(connection, HTTP_STATUS_NOT_FOUND, kPlainText, "There is no such page.\n");
}

int WebServer::Implementation::serve_page(lws* connection, const PageFile& file, bool is_asset) {
  // Names of assets contain a hash of their content.
  constexpr const char* kForever = "public, max-age=31536000, immutable";
  return answer(connection, HTTP_STATUS_OK, file.content_type.c_str(), file.content,
                {.cache_control = is_asset ? kForever : "no-cache"});
}

// Reads the page's files again, because the page may have been built in the meantime.
void WebServer::Implementation::read_files_again() {
  if (std::exchange(reads_files_, true)) return;
  hub_.file_thread().run([this, folder = settings_.page_folder, former = files_]() -> FileThread::Finish {
    std::shared_ptr<const PageFiles> files;
    try {
      files = std::make_shared<const PageFiles>(folder, former.get());
    } catch (const std::exception&) {  // out of memory: the former files are served
    }
    return [this, files] {
      reads_files_ = false;
      if (files != nullptr) files_ = files;
    };
  });
}

int WebServer::Implementation::complete(lws* connection) {
  return lws_http_transaction_completed(connection) != 0 ? -1 : 0;
}

bool WebServer::Implementation::write_headers(lws* connection, unsigned status, const char* type,
                                              std::uint64_t body_bytes, const AnswerHeaders& further) {
  HeaderBuffer headers;
  const auto add = [&](const char* name, std::string_view text) {
    return lws_add_http_header_by_name(connection, reinterpret_cast<const unsigned char*>(name),
                                       reinterpret_cast<const unsigned char*>(text.data()),
                                       static_cast<int>(text.size()), &headers.next, headers.end) != 0;
  };
  return lws_add_http_common_headers(connection, status, type, body_bytes, &headers.next, headers.end) == 0 &&
         !add("cache-control:", further.cache_control) &&
         (further.name == nullptr || !add(further.name, further.value)) &&
         lws_finalize_write_http_header(connection, headers.begin, &headers.next, headers.end) == 0;
}

int WebServer::Implementation::answer(lws* connection, unsigned status, const char* type, std::string_view body,
                                      const AnswerHeaders& further) {
  if (!write_headers(connection, status, type, body.size(), further)) return -1;
  HttpRequest& request = requests_[connection];
  request = {};
  request.body.assign(LWS_PRE, '\0');
  request.body.append(body);
  ask_to_write(connection);
  return 0;
}

int WebServer::Implementation::begin_pictures(lws* connection, HttpRequest::Kind kind) {
  const Instant now = hal::MonotonicClock::read();
  const bool is_stream = kind == HttpRequest::Kind::kStream;
  const auto pictures = std::count_if(requests_.begin(), requests_.end(), [](const auto& entry) {
    return entry.second.kind == HttpRequest::Kind::kSnapshot || entry.second.kind == HttpRequest::Kind::kStream;
  });
  if (kind != HttpRequest::Kind::kBugReport && pictures >= kMaxStreams) {
    return answer(connection, HTTP_STATUS_SERVICE_UNAVAILABLE, kPlainText, "Too many streams are open.\n");
  }
  if (is_stream) {
    HeaderBuffer headers;
    if (lws_add_http_common_headers(connection, HTTP_STATUS_OK, "multipart/x-mixed-replace; boundary=frame",
                                    LWS_ILLEGAL_HTTP_CONTENT_LEN, &headers.next, headers.end) != 0 ||
        lws_finalize_write_http_header(connection, headers.begin, &headers.next, headers.end) != 0) {
      return -1;
    }
  }
  lws_set_timeout(connection, NO_PENDING_TIMEOUT, 0);  // no timeout, because sending a stream has no end
  HttpRequest& request = requests_[connection];
  request = {};
  request.kind = kind;
  request.picture = hub_.next_picture_number();
  request.begin = now;
  hub_.request_picture(now);
  schedule(Duration::zero());
  return 0;
}

int WebServer::Implementation::begin_bug_report(lws* connection) {
  const bool is_wanted = is_asked_for(HttpRequest::Kind::kBugReport);
  // Discard an answer that nobody waits for any more.
  if (!is_wanted && reporter_.is_done()) static_cast<void>(reporter_.take());
  if (is_wanted || reporter_.is_busy()) {
    return answer(connection, HTTP_STATUS_SERVICE_UNAVAILABLE, kPlainText, "Another bug report is on its way.\n");
  }
  return begin_pictures(connection, HttpRequest::Kind::kBugReport);
}

int WebServer::Implementation::write_bug_report(lws* connection, HttpRequest& request, Instant now) {
  if (!request.body.empty()) return write_body(connection, request, kBodyPart);
  if (!is_ready(request, now)) return 0;
  if (!request.is_made) {
    BugReportContent content = hub_.bug_report_content(request.picture, now);
    content.secret = settings_.access.token;
    request.is_made = true;
    reporter_.start([content = std::move(content)]() -> MadeAnswer {
      return {bug_report_name(content), make_bug_report(content)};
    });
    return 0;
  }
  const MadeAnswer report = reporter_.take();
  if (report.bytes.empty()) {
    return answer(connection, HTTP_STATUS_INTERNAL_SERVER_ERROR, kPlainText, "Memory is too short for a report.\n");
  }
  const std::string file_name = "attachment; filename=\"" + report.name + ".tar.gz\"";
  const int answered = answer(connection, HTTP_STATUS_OK, "application/gzip", report.bytes,
                              {.name = "content-disposition:", .value = file_name});
  request.kind = HttpRequest::Kind::kBugReport;
  return answered;
}

bool WebServer::Implementation::is_asked_for(HttpRequest::Kind kind) const {
  return std::any_of(requests_.begin(), requests_.end(),
                     [kind](const auto& entry) { return entry.second.kind == kind; });
}

int WebServer::Implementation::begin_devices(lws* connection, std::function<std::string()> list) {
  const bool is_wanted = is_asked_for(HttpRequest::Kind::kDevices);
  if (!is_wanted && device_lister_.is_done()) static_cast<void>(device_lister_.take());
  if (is_wanted || device_lister_.is_busy()) {
    return answer(connection, HTTP_STATUS_SERVICE_UNAVAILABLE, kPlainText, "Devices are being listed already.\n");
  }
  lws_set_timeout(connection, NO_PENDING_TIMEOUT, 0);  // no timeout, because every camera takes some time
  HttpRequest& request = requests_[connection];
  request = {};
  request.kind = HttpRequest::Kind::kDevices;
  request.is_made = true;
  device_lister_.start([list = std::move(list)]() -> MadeAnswer { return {"", list()}; });
  schedule(Duration::zero());
  return 0;
}

int WebServer::Implementation::write_devices(lws* connection, HttpRequest& request) {
  if (!request.body.empty()) return write_body(connection, request, kBodyPart);
  if (!device_lister_.is_done()) return 0;
  const MadeAnswer list = device_lister_.take();
  if (list.bytes.empty()) {
    return answer(connection, HTTP_STATUS_INTERNAL_SERVER_ERROR, kPlainText, "Memory is too short for a list.\n");
  }
  return answer(connection, HTTP_STATUS_OK, "application/json", list.bytes);
}

bool WebServer::Implementation::is_waiting(const HttpRequest& request) const {
  return request.kind != HttpRequest::Kind::kText && request.body.empty();
}

bool WebServer::Implementation::is_ready(const HttpRequest& request, Instant now) {
  if (request.kind == HttpRequest::Kind::kDevices) return device_lister_.is_done();
  if (request.kind == HttpRequest::Kind::kRecording) return request.made.has_value();
  if (request.is_made) return reporter_.is_done();
  const bool is_late = request.kind != HttpRequest::Kind::kStream && now - request.begin > kPictureWait;
  return is_late || hub_.has_picture(request.picture);
}

int WebServer::Implementation::write_request(lws* connection) {
  const auto found = requests_.find(connection);
  if (found == requests_.end()) return 0;
  HttpRequest& request = found->second;
  if (request.kind == HttpRequest::Kind::kStream) return write_stream_part(connection, request);
  if (request.kind == HttpRequest::Kind::kSnapshot)
    return write_snapshot(connection, request, hal::MonotonicClock::read());
  if (request.kind == HttpRequest::Kind::kBugReport)
    return write_bug_report(connection, request, hal::MonotonicClock::read());
  if (request.kind == HttpRequest::Kind::kDevices) return write_devices(connection, request);
  if (request.kind == HttpRequest::Kind::kRecording) return write_recording(connection, request);
  return write_body(connection, request, kBodyPart);
}

int WebServer::Implementation::write_body(lws* connection, HttpRequest& request, std::size_t most) {
  const std::size_t size = std::min(request.body.size() - request.sent, most);
  auto* const part = reinterpret_cast<unsigned char*>(request.body.data()) + request.sent;
  request.sent += size;
  const bool is_last = request.sent == request.body.size();
  // libwebsockets keeps the bytes that the socket does not take at once.
  const int written = lws_write(connection, part, size, is_last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP);
  if (written < 0) return -1;
  if (!is_last) {
    ask_to_write(connection);
    return 0;
  }
  requests_.erase(connection);
  return complete(connection);
}

int WebServer::Implementation::write_snapshot(lws* connection, HttpRequest& request, Instant now) {
  if (!is_ready(request, now)) return 0;
  const std::span<std::byte> jpeg = hub_.current_jpeg(request.picture);
  if (jpeg.empty()) {
    return answer(connection, HTTP_STATUS_SERVICE_UNAVAILABLE, kPlainText, "The camera delivers no pictures.\n");
  }
  return answer(connection, HTTP_STATUS_OK, "image/jpeg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
}

int WebServer::Implementation::write_stream_part(lws* connection, HttpRequest& request) {
  const std::span<std::byte> jpeg = hub_.current_jpeg(request.picture);
  if (jpeg.empty()) return 0;
  request.picture = hub_.picture_number() + 1;
  std::array<char, kMessagePrefix + kPictureHeaderBytes - LWS_PRE> header{};
  const int size = std::snprintf(header.data(), header.size(),
                                 "--frame\r\ncontent-type: image/jpeg\r\ncontent-length: %zu\r\n\r\n", jpeg.size());
  if (size < 0 || static_cast<std::size_t>(size) >= header.size()) return -1;
  // The part's header is written into the free bytes in front of the picture. The line end after the picture belongs to
  // the next boundary, and readers use the length.
  auto* const begin = reinterpret_cast<unsigned char*>(jpeg.data()) - size;
  std::memcpy(begin, header.data(), static_cast<std::size_t>(size));
  const int written = lws_write(connection, begin, jpeg.size() + static_cast<std::size_t>(size), LWS_WRITE_HTTP);
  return written < 0 ? -1 : 0;
}

}  // namespace touchline::console
