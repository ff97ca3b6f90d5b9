#include "tests/linux/fake_dma.h"

#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <utility>

namespace touchline::fake {

void DmaBufferFile::write(std::size_t offset, const std::vector<std::uint8_t>& bytes) {
  if (reading_) violation_ = "written during a read";
  std::copy(bytes.begin(), bytes.end(), memory_.begin() + static_cast<std::ptrdiff_t>(offset));
  if (!is_dma) cached_ = memory_;
}

int DmaBufferFile::ioctl(unsigned long request, void* argument) {
  if (request != DMA_BUF_IOCTL_SYNC || !is_dma) return -ENOTTY;
  if (fail_with != 0) return -std::exchange(fail_with, 0);
  const std::uint64_t flags = static_cast<const dma_buf_sync*>(argument)->flags;
  const bool end = (flags & DMA_BUF_SYNC_END) != 0;
  if ((flags & DMA_BUF_SYNC_RW) != DMA_BUF_SYNC_READ) violation_ = "synchronized for something other than reading";
  if (reading_ != end) violation_ = end ? "end of a read without its beginning" : "read begun twice";
  reading_ = !end;
  if (!end) std::copy(memory_.begin(), memory_.end(), cached_.begin());
  return 0;
}

void* DmaBufferFile::map(std::size_t length, long offset, int protection) {
  if (mapped_ || offset != 0 || length > cached_.size() || protection != PROT_READ) return nullptr;
  mapped_ = true;
  return cached_.data();
}

bool DmaBufferFile::unmap(void* memory) {
  if (!mapped_ || memory != cached_.data()) return false;
  mapped_ = false;
  return true;
}

int DmaHeapFile::ioctl(unsigned long request, void* argument) {
  if (request != DMA_HEAP_IOCTL_ALLOC) return -ENOTTY;
  auto& allocation = *static_cast<dma_heap_allocation_data*>(argument);
  if (allocation.len > room) return -ENOMEM;
  room -= allocation.len;
  buffers_.push_back(std::make_unique<DmaBufferFile>(allocation.len));
  allocation.fd = static_cast<std::uint32_t>(kernel()->adopt(*buffers_.back()));
  return 0;
}

}  // namespace touchline::fake
