#pragma once

namespace touchline::hal {

// Memory that devices share (dma-buf) may be cached for the processor while a device writes past the caches: what the
// processor reads between these two calls is what the device wrote. 0 or an errno; ENOTTY: no dma-buf; EAGAIN,
// EINTR: the driver would not, however often it was asked.
[[nodiscard]] int begin_cpu_read(int dma_buf);
[[nodiscard]] int end_cpu_read(int dma_buf);

}  // namespace touchline::hal
