#pragma once

#include <libwebsockets.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "firmware/console/answer_worker.h"
#include "firmware/console/page_files.h"
#include "firmware/console/web_server.h"

// Declarations that the sources web_*.cpp of the server share.
namespace touchline::console {

static_assert(kMessagePrefix >= LWS_PRE, "libwebsockets writes its header in front of a message");

inline constexpr const char* kPlainText = "text/plain; charset=utf-8";

/// A request that is being answered.
struct HttpRequest {
  enum class Kind : std::uint8_t { kText, kSnapshot, kStream, kBugReport, kDevices, kRecording };
  Kind kind = Kind::kText;
  std::string body;            // body of the answer with LWS_PRE bytes in front; unused if pictures are sent
  std::size_t sent = LWS_PRE;  // bytes of the body already sent
  std::uint64_t picture = 0;   // lowest number of the next picture
  Instant begin{};             // begin of the wait for a picture
  bool is_made = false;        // a slow answer is being made
  // of kRecording
  std::uint64_t job = 0;                      // number of the job that makes the answer, or its next part
  std::optional<Result<std::string>> made{};  // by the job
  const char* type = "";                      // of the content
  std::string name;                           // of the file to be sent in parts; "": the answer is whole
  std::uint64_t offset = 0, size = 0;         // of the file: what was sent, and all
};

/// Headers of an answer in addition to the usual ones.
struct AnswerHeaders {
  const char* cache_control = "no-store";
  const char* name = nullptr;  // name with its colon; null: no further header
  std::string_view value{};
};

/// A WebSocket connection.
struct Socket {
  Client* client = nullptr;
  std::uint64_t confirmed_before = 0;  // bytes that the other computer had confirmed before the first message
  std::string received;                // beginning of a message that has not arrived completely
};

/// A connection that is not (yet) a WebSocket.
struct Visitor {
  std::string address;
  Instant since{};  // time at which it was accepted, or last sent something
  bool is_closing = false;
};

/// Handles the callbacks of libwebsockets. Connections are found by their handle.
class WebServer::Implementation {
 public:
  Implementation(Hub& hub, WebServerSettings settings);
  ~Implementation();
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  Result<void> open();
  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] lws_context* context() const { return context_; }

  int on_http(lws* connection, lws_callback_reasons reason, void* in);
  int on_socket(lws* connection, lws_callback_reasons reason, void* in, std::size_t size);

 private:
  // Functions in web_server.cpp.
  void tick();
  void schedule(Duration in);
  void close_unread(Instant now);
  void ask_to_write(lws* connection);
  void forget(lws* connection);

  // Functions in web_visitors.cpp.
  void admit(lws* connection);
  /// Closes the least important visitor, if there are too many.
  void limit_visitors();
  [[nodiscard]] bool is_long_request(lws* connection) const;
  /// Makes room for another Stop connection by closing the one that has been silent for the longest time.
  void limit_stop_lines();
  void close(lws* connection);

  // Functions in web_access.cpp.
  /// Returns nothing if the request is permitted, else the status and the text of the answer.
  struct Refusal {
    unsigned status;
    std::string text;
  };
  enum class Purpose : std::uint8_t { kConsole, kNavigation, kFoxglove };
  [[nodiscard]] std::optional<Refusal> check(lws* connection, Purpose purpose) const;
  [[nodiscard]] bool has_token(lws* connection, Purpose purpose) const;
  int login(lws* connection);

  // Functions in web_http.cpp.
  int begin_request(lws* connection, std::string_view path);
  void read_files_again();
  int serve_page(lws* connection, const PageFile& file, bool is_asset);
  /// Writes status and headers of an answer with a body of so many bytes. Returns false if the connection must end.
  bool write_headers(lws* connection, unsigned status, const char* type, std::uint64_t body_bytes,
                     const AnswerHeaders& further);
  int answer(lws* connection, unsigned status, const char* type, std::string_view body,
             const AnswerHeaders& further = {});
  int begin_pictures(lws* connection, HttpRequest::Kind kind);
  int begin_bug_report(lws* connection);
  int write_bug_report(lws* connection, HttpRequest& request, Instant now);
  int begin_devices(lws* connection, std::function<std::string()> list);
  int write_devices(lws* connection, HttpRequest& request);

  // Functions in web_recordings.cpp.
  int begin_recordings(lws* connection, std::string_view path);
  /// Lets the thread for recordings make the answer or the next part of it.
  void make_recording(lws* connection, HttpRequest& request,
                      std::function<Result<std::string>(Recordings& recordings)> make);
  int write_recording(lws* connection, HttpRequest& request);
  int begin_file(lws* connection, HttpRequest& request, std::uint64_t size);

  [[nodiscard]] bool is_asked_for(HttpRequest::Kind kind) const;
  int write_body(lws* connection, HttpRequest& request, std::size_t most);
  int write_request(lws* connection);
  int write_stream_part(lws* connection, HttpRequest& request);
  int write_snapshot(lws* connection, HttpRequest& request, Instant now);
  [[nodiscard]] bool is_waiting(const HttpRequest& request) const;
  [[nodiscard]] bool is_ready(const HttpRequest& request, Instant now);
  [[nodiscard]] static int complete(lws* connection);

  // Functions in web_socket.cpp.
  int accept_socket(lws* connection);
  int receive(lws* connection, std::string_view part);
  int write_socket(lws* connection);
  void measure_links(Instant now);
  int end_socket(lws* connection, lws_close_status status, std::string_view reason);

  struct Timer {
    lws_sorted_usec_list_t list;  // must be first, because libwebsockets passes its address
    Implementation* owner;
  };

  Hub& hub_;
  const WebServerSettings settings_;
  std::shared_ptr<const PageFiles> files_;
  bool reads_files_ = false;
  const lws_retry_bo_t idle_policy_;
  lws_context* context_ = nullptr;
  lws_vhost* host_ = nullptr;
  Timer timer_{};
  std::map<lws*, HttpRequest> requests_;
  std::uint64_t last_job_ = 0;
  AnswerWorker reporter_;
  // Its queries lower their own priority, except those whose threads may serve the loop later.
  AnswerWorker device_lister_{FileThread::Priority::kNormal};
  std::map<lws*, Visitor> visitors_;
  std::map<lws*, Socket> sockets_;
  std::map<lws*, Instant> waiting_;  // connections that wait to be written to, and since when
};

/// Returns a header of the request; "" if it is absent or longer than a kilobyte.
std::string header_of(lws* connection, lws_token_indexes token);

}  // namespace touchline::console
