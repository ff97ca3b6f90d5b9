#include "hal/linux/dma_buf.h"

#include <linux/dma-buf.h>
#include <sys/ioctl.h>

#include <cerrno>

namespace touchline::hal {
namespace {

int synchronize(int dma_buf, unsigned long long flags) {
  dma_buf_sync request{flags};
  int result = 0;
  do {
    result = ::ioctl(dma_buf, DMA_BUF_IOCTL_SYNC, &request);
  } while (result < 0 && (errno == EINTR || errno == EAGAIN));  // as the kernel's document asks
  return result < 0 ? errno : 0;
}

}  // namespace

int begin_cpu_read(int dma_buf) { return synchronize(dma_buf, DMA_BUF_SYNC_START | DMA_BUF_SYNC_READ); }
int end_cpu_read(int dma_buf) { return synchronize(dma_buf, DMA_BUF_SYNC_END | DMA_BUF_SYNC_READ); }

}  // namespace touchline::hal
