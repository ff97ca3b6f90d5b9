#pragma once

#include <cstddef>
#include <span>

// Terminals without a UART: pseudo terminals, which libserialport does not accept, and Bluetooth's serial ports. They
// have no baud rate. Functions return a number or a negative errno, and none blocks.
namespace touchline::hal::terminal {

/// Opens a terminal and passes all bytes on unchanged. Returns its descriptor; -ENOTTY: the file is no terminal.
int open_raw(const char* path);
/// Returns the number of bytes that were accepted or received; 0: none at the moment. -EIO: the other side is gone.
int write(int file, std::span<const std::byte> bytes);
int read(int file, std::span<std::byte> into);
/// Returns the number of bytes that wait to be sent.
int output_waiting(int file);
/// Drops bytes that were not sent, and closes.
void close(int file);

}  // namespace touchline::hal::terminal
