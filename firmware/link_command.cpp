#include "firmware/link_command.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
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

// "HOST" becomes this computer's name. Other networks stay closed, so that a board that gets a public address is not
// open.
constexpr const char* kDropIn = R"(# Written by "touchline link"; "touchline link --undo" removes it.
[Service]
RestrictAddressFamilies=AF_INET
IPAddressAllow=localhost link-local 10.0.0.0/8 172.16.0.0/12 192.168.0.0/16
ExecStart=
ExecStart=/usr/bin/touchline run --board /etc/touchline/board.toml --set console.enabled=true \
    --set 'console.address="0.0.0.0:8642"' --set 'console.hosts+=["touchline.local", "HOST.local"]'
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
  return ::gethostname(name.data(), name.size() - 1) == 0
             ? std::string(name.data()).substr(0, std::string(name.data()).find('.'))  // without the domain
             : "localhost";
}

/// Nothing of the caller's environment reaches the program, which runs as root.
Result<void> systemctl(const LinkOptions& options, const std::string& arguments) {
  const std::string command =
      "/usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin '" + options.systemctl + "' " + arguments;
  const int code = std::system(command.c_str());  // NOLINT(cert-env33-c,concurrency-mt-unsafe): fixed arguments
  if (code == 0) return {};
  return failure(ErrorCode::kIo, "systemctl %s failed, see above", arguments.c_str());
}

Result<void> restart(const LinkOptions& options) {
  TOUCHLINE_TRY(systemctl(options, "daemon-reload"));
  return systemctl(options, "restart touchline.service");
}

/// Gives the file to the service's user. The folder belongs to that user, who must not be able to put another file in
/// its place: the open file is changed, not what its name leads to.
Result<void> give_to_service(const std::string& path, bool must_have_user) {
  const passwd* const user = ::getpwnam("touchline");  // NOLINT(concurrency-mt-unsafe): one thread
  if (user == nullptr && must_have_user) {
    return failure(ErrorCode::kNotFound, "the system has no user touchline: install the package touchline again");
  }
  if (user == nullptr) return {};
  const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  struct stat status {};
  const bool is_own_file = file >= 0 && ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink == 1;
  const bool is_given = is_own_file && ::fchown(file, user->pw_uid, user->pw_gid) == 0;
  if (file >= 0) ::close(file);
  if (is_given) return {};
  return failure(ErrorCode::kIo, "%s: cannot be given to the user touchline; remove it and try again", path.c_str());
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
    fs::remove(paths.drop_in, error);
    if (error)
      return failure(ErrorCode::kIo, "%s: cannot be removed: %s", paths.drop_in.c_str(), error.message().c_str());
    fs::remove(paths.announced, error);
    // Also if there was no drop-in: an earlier attempt may have removed it and failed here.
    TOUCHLINE_TRY(restart(options));
    return std::string("the page is closed to other computers; the service was restarted\n");
  }
  const auto configuration = std::make_unique<config::Configuration>();
  TOUCHLINE_TRY(config::load_board(paths.board, {}, *configuration));
  const std::string token_file = options.root + configuration->board.console.token_file;
  TOUCHLINE_TRY_ASSIGN(const std::string token, console::make_token(token_file));
  TOUCHLINE_TRY(give_to_service(token_file, options.root.empty()));
  TOUCHLINE_TRY(systemctl(options, "enable --quiet --now touchline-setup.service"));  // for Set up of the page
  // Last, so that nothing is open after an error.
  std::string text = kDropIn;
  const std::string host = host_name();
  text.replace(text.find("HOST"), 4, host);
  fs::create_directories(fs::path(paths.drop_in).parent_path(), error);
  TOUCHLINE_TRY(hal::write_file(paths.drop_in, text));
  if (Result<void> restarted = restart(options); !restarted.ok()) {
    fs::remove(paths.drop_in, error);
    return std::move(restarted).error();
  }
  const bool is_announced =
      fs::is_directory(fs::path(paths.announced).parent_path(), error) &&
      fs::copy_file(paths.announcement, paths.announced, fs::copy_options::overwrite_existing, error);
  return "the page is open to computers in private networks; the service was restarted\n" +
         (options.is_terminal ? console::login_text("0.0.0.0", kPort, token)
                              : std::string("sudo -u touchline touchline console --link prints the login links\n")) +
         (is_announced
              ? "By name: http://" + host + ".local:8642/login?token=... (the same token)\n"
              : "With the package avahi-daemon, the board is found by name, as http://" + host + ".local:8642\n") +
         "The score of \"systemd-analyze security touchline\" is now 1.6 instead of 1.2, since the service may use "
         "the\n"
         "network. touchline link --undo closes the page again.\n";
}

}  // namespace touchline
