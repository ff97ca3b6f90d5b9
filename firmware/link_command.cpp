#include "firmware/link_command.h"

#include <pwd.h>
#include <unistd.h>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <utility>

#include "firmware/config/configuration.h"
#include "firmware/console/access.h"
#include "firmware/console/login_link.h"
#include "hal/files/output_file.h"

namespace touchline {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t kPort = 8642;

// "HOST" becomes this computer's name. Other networks stay closed, so that the page is not reachable even if the board
// gets a public address.
constexpr const char* kDropIn = R"(# Written by "touchline link"; "touchline link --undo" removes it.
[Service]
RestrictAddressFamilies=AF_INET
IPAddressAllow=localhost link-local 10.0.0.0/8 172.16.0.0/12 192.168.0.0/16
ExecStart=
ExecStart=/usr/bin/touchline run --board /etc/touchline/board.toml --set console.enabled=true \
    --set 'console.address="0.0.0.0:8642"' --set 'console.hosts=["touchline.local", "HOST.local"]'
)";

struct Paths {
  explicit Paths(const std::string& root)
      : board(root + "/etc/touchline/board.toml"),
        unit(root + "/usr/lib/systemd/system/touchline.service"),
        drop_in(root + "/etc/systemd/system/touchline.service.d/link.conf"),
        announcement(root + "/usr/share/touchline/avahi/touchline.service"),
        announced(root + "/etc/avahi/services/touchline.service") {}
  std::string board, unit, drop_in, announcement, announced;
};

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

/// Runs systemctl as root. The path is fixed, so that the environment cannot choose another program.
Result<void> systemctl(const std::string& arguments) {
  const int code = std::system(("systemctl " + arguments).c_str());  // NOLINT(cert-env33-c,concurrency-mt-unsafe)
  if (code == 0) return {};
  return failure(ErrorCode::kIo, "systemctl %s failed, see above", arguments.c_str());
}

Result<void> restart() {
  TOUCHLINE_TRY(systemctl("daemon-reload"));
  return systemctl("restart touchline.service");
}

/// Makes the token of the service, readable for the service's user.
Result<std::string> make_service_token(const std::string& root, const std::string& file) {
  const std::string path = root + file;
  TOUCHLINE_TRY_ASSIGN(std::string token, console::make_token(path));
  const passwd* const user = ::getpwnam("touchline");  // NOLINT(concurrency-mt-unsafe): one thread
  if (user != nullptr && ::chown(path.c_str(), user->pw_uid, user->pw_gid) != 0) {
    return failure(ErrorCode::kIo, "%s: cannot be given to the user touchline", path.c_str());
  }
  return token;
}

}  // namespace

Result<std::string> link_command(const LinkOptions& options) {
  const Paths paths(options.root);
  std::error_code error;
  if (options.root.empty() && ::geteuid() != 0) {
    return failure(ErrorCode::kPermission, "link changes the system's service: run it with sudo");
  }
  if (!fs::exists(paths.unit, error)) {
    return failure(ErrorCode::kNotFound,
                   "%s: the service is not installed (docs/deploy.md); without it: touchline run --lan",
                   paths.unit.c_str());
  }
  if (options.is_undone) {
    const bool was_linked = fs::remove(paths.drop_in, error);
    fs::remove(paths.announced, error);
    if (!was_linked) return std::string("the page was not open to other computers\n");
    TOUCHLINE_TRY(restart());
    return std::string("the page is closed to other computers; the service was restarted\n");
  }
  const auto configuration = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load_board(paths.board, {}, *configuration));
  TOUCHLINE_TRY_ASSIGN(const std::string token,
                       make_service_token(options.root, configuration->board.console.token_file));
  std::string text = kDropIn;
  const std::string host = host_name();
  text.replace(text.find("HOST"), 4, host);
  fs::create_directories(fs::path(paths.drop_in).parent_path(), error);
  TOUCHLINE_TRY(hal::write_file(paths.drop_in, text));
  const bool has_avahi = fs::is_directory(fs::path(paths.announced).parent_path(), error);
  if (has_avahi) fs::copy_file(paths.announcement, paths.announced, fs::copy_options::overwrite_existing, error);
  TOUCHLINE_TRY(systemctl("enable --quiet --now touchline-setup.service"));  // needed by "Set up" of the page
  TOUCHLINE_TRY(restart());
  return "the page is open to computers in private networks; the service was restarted\n" +
         console::login_text("0.0.0.0", kPort, token) +
         (has_avahi ? "By name: http://" + host + ".local:8642/login?token=... (the same token)\n"
                    : std::string("With the package avahi-daemon, the board is found by name, as http://") + host +
                          ".local:8642\n") +
         "The score of \"systemd-analyze security touchline\" is now 1.6 instead of 1.2, since the service may use "
         "the\n"
         "network. touchline link --undo closes the page again.\n";
}

}  // namespace touchline
