#pragma once

namespace touchline::hal {

// Memory that devices share (a dma-buf) may be in the processor's caches while a device writes past them. What the
// processor reads between these two calls (DMA_BUF_IOCTL_SYNC) is what the device wrote. They return 0 or an errno;
// ENOTTY: not a dma-buf; EAGAIN, EINTR: the driver refused repeatedly.
[[nodiscard]] int begin_cpu_read(int dma_buf);
[[nodiscard]] int end_cpu_read(int dma_buf);

}  // namespace touchline::hal
