#include "firmware/console/login_link.h"

#include <qrencode.h>

#include <memory>
#include <vector>

#include "hal/linux/network/local_addresses.h"

namespace touchline::console {
namespace {

// Width of the empty border around the code in modules. The standard asks for four, but readers manage with two.
constexpr int kQuietZone = 2;

}  // namespace

std::string qr_code(const std::string& text) {
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
      QRcode_encodeString(text.c_str(), 0, QR_ECLEVEL_L, QR_MODE_8, 1), &QRcode_free);
  if (code == nullptr) return {};
  const auto is_dark = [&](int row, int column) {
    const bool is_inside = row >= 0 && column >= 0 && row < code->width && column < code->width;
    return is_inside && (code->data[row * code->width + column] & 1) != 0;
  };
  std::string drawn;
  for (int row = -kQuietZone; row < code->width + kQuietZone; row += 2) {
    drawn += "\033[30;47m";  // black on white, whatever the terminal's colors are
    for (int column = -kQuietZone; column < code->width + kQuietZone; ++column) {
      const bool upper = is_dark(row, column), lower = is_dark(row + 1, column);
      drawn += upper && lower ? "█" : upper ? "▀" : lower ? "▄" : " ";
    }
    drawn += "\033[0m\n";
  }
  return drawn;
}

std::string login_text(const std::string& address, std::uint16_t port, const std::string& token) {
  std::vector<hal::LocalAddress> addresses;
  if (address == "0.0.0.0") {
    addresses = hal::local_addresses();
  } else {
    addresses.push_back({"", address});
  }
  if (addresses.empty()) return "no network: other computers cannot reach this one\n";
  std::string text = "from other computers and phones:\n", first;
  for (const hal::LocalAddress& local : addresses) {
    const std::string link = "http://" + local.address + ":" + std::to_string(port) + "/login?token=" + token;
    if (first.empty()) first = link;
    text += "  " + link + (local.interface.empty() ? "" : "  (" + local.interface + ")") + "\n";
  }
  return text + qr_code(first) +
         "This is HTTP: others on the network can read the link and what the page shows. In a network that you do not\n"
         "trust, use an ssh tunnel (ssh -L " +
         std::to_string(port) + ":127.0.0.1:" + std::to_string(port) +
         " THIS_COMPUTER), or a web server with your own certificate in front of it.\n";
}

}  // namespace touchline::console
