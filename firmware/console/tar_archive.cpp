#include "firmware/console/tar_archive.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>
#include <new>
#include <utility>

namespace touchline::console {
namespace {

constexpr std::size_t kTarBlock = 512;
// Offsets in the header.
constexpr std::size_t kTarName = 0, kTarNameBytes = 100, kTarMode = 100, kTarUser = 108, kTarGroup = 116,
                      kTarSize = 124, kTarTime = 136, kTarChecksum = 148, kTarChecksumBytes = 8, kTarType = 156,
                      kTarMagic = 257;

using TarHeader = std::array<char, kTarBlock>;

void put_octal(TarHeader& header, std::size_t at, std::size_t digits, std::uint64_t value) {
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), "%0*" PRIo64, static_cast<int>(digits), value);
  std::copy_n(text.begin(), digits, header.begin() + static_cast<std::ptrdiff_t>(at));
}

void put_text(TarHeader& header, std::size_t at, std::string_view text) {
  std::copy(text.begin(), text.end(), header.begin() + static_cast<std::ptrdiff_t>(at));
}

TarHeader header_of_file(const std::string& name, std::size_t bytes, std::int64_t time_s) {
  TarHeader header{};
  put_text(header, kTarName, std::string_view(name).substr(0, kTarNameBytes - 1));
  put_octal(header, kTarMode, 7, 0644);
  put_octal(header, kTarUser, 7, 0);
  put_octal(header, kTarGroup, 7, 0);
  put_octal(header, kTarSize, 11, bytes);
  put_octal(header, kTarTime, 11, static_cast<std::uint64_t>(std::max<std::int64_t>(time_s, 0)));
  header[kTarType] = '0';
  put_text(header, kTarMagic, std::string_view("ustar\00000", 8));
  // The checksum is computed as if its own field contained spaces.
  std::fill_n(header.begin() + kTarChecksum, kTarChecksumBytes, ' ');
  std::uint64_t sum = 0;
  for (const char c : header) sum += static_cast<unsigned char>(c);
  put_octal(header, kTarChecksum, 6, sum);
  header[kTarChecksum + 6] = '\0';
  return header;
}

}  // namespace

TarArchive::TarArchive(std::string folder, std::int64_t time_s) : folder_(std::move(folder)), time_s_(time_s) {
  // window bits: the largest window, plus 16 for the header and the checksum of gzip
  constexpr int kWindowBits = 15 + 16, kMemoryLevel = 8;
  if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kWindowBits, kMemoryLevel, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    throw std::bad_alloc();
  }
}

void TarArchive::add(std::string_view name, std::string_view bytes) {
  const TarHeader header = header_of_file(folder_ + "/" + std::string(name), bytes.size(), time_s_);
  constexpr std::array<char, kTarBlock> kZeros{};
  const std::size_t rest = bytes.size() % kTarBlock;
  compress({header.data(), header.size()}, Z_NO_FLUSH);
  compress(bytes, Z_NO_FLUSH);
  if (rest > 0) compress({kZeros.data(), kTarBlock - rest}, Z_NO_FLUSH);
}

std::string TarArchive::finish() {
  constexpr std::array<char, 2 * kTarBlock> kTwoBlocks{};
  compress({kTwoBlocks.data(), kTwoBlocks.size()}, Z_FINISH);
  return std::move(compressed_);
}

void TarArchive::compress(std::string_view bytes, int flush) {
  std::array<char, std::size_t{16} * 1024> out;
  // zlib only reads through this member, although it is not const.
  stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream_.avail_in = static_cast<uInt>(bytes.size());
  do {
    stream_.next_out = reinterpret_cast<Bytef*>(out.data());
    stream_.avail_out = static_cast<uInt>(out.size());
    static_cast<void>(::deflate(&stream_, flush));
    compressed_.append(out.data(), out.size() - stream_.avail_out);
  } while (stream_.avail_out == 0);
}

}  // namespace touchline::console
