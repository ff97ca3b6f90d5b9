#include "hal/linux/dma_buf.h"

#include <linux/dma-buf.h>
#include <sys/ioctl.h>

#include <cerrno>

namespace touchline::hal {
namespace {

// The loop calls this with real-time priority: a driver that is never ready must not block it. About a millisecond.
constexpr int kMostTries = 1000;

int synchronize(int dma_buf, unsigned long long flags) {
  dma_buf_sync request{flags};
  for (int tries = 1;; ++tries) {
    if (::ioctl(dma_buf, DMA_BUF_IOCTL_SYNC, &request) == 0) return 0;
    const bool again = errno == EINTR || errno == EAGAIN;  // the kernel's documentation asks to repeat the call
    if (!again || tries == kMostTries) return errno;
  }
}

}  // namespace

int begin_cpu_read(int dma_buf) { return synchronize(dma_buf, DMA_BUF_SYNC_START | DMA_BUF_SYNC_READ); }
int end_cpu_read(int dma_buf) { return synchronize(dma_buf, DMA_BUF_SYNC_END | DMA_BUF_SYNC_READ); }

}  // namespace touchline::hal
