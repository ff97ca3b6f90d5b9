#include "hal/linux/dma_buffer.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "tests/linux/fake_dma.h"
#include "tests/linux/fake_kernel.h"

namespace touchline::hal {
namespace {

class DmaBufferTest : public ::testing::Test {
 protected:
  fake::Kernel kernel_;
};

TEST_F(DmaBufferTest, TheFirstAvailableHeapIsUsedAndARefusalIsReported) {
  DmaHeap heap;
  EXPECT_EQ(heap.open(), ENOENT);
  EXPECT_EQ(heap.name(), std::string());
  fake::DmaHeapFile contiguous, named;
  kernel_.add("/dev/dma_heap/linux,cma", contiguous);
  ASSERT_EQ(heap.open(), 0);
  EXPECT_EQ(heap.name(), std::string("/dev/dma_heap/linux,cma"));
  kernel_.add("/dev/dma_heap/default_cma_region", named);
  ASSERT_EQ(heap.open(), 0);
  EXPECT_EQ(heap.name(), std::string("/dev/dma_heap/default_cma_region"));
  kernel_.remove("/dev/dma_heap/default_cma_region");
  kernel_.add("/dev/dma_heap/vidbuf_cached", named);
  ASSERT_EQ(heap.open(), 0);
  EXPECT_EQ(heap.name(), std::string("/dev/dma_heap/vidbuf_cached"));
  int file = -1;
  ASSERT_EQ(heap.allocate(8192, file), 0);
  EXPECT_EQ(named.buffers().at(0)->size(), 8192u);
  ::close(file);
  heap.close();
  kernel_.refuse_open("/dev/dma_heap/vidbuf_cached", EACCES);
  kernel_.refuse_open("/dev/dma_heap/linux,cma", EPERM);
  EXPECT_EQ(heap.open(), EACCES);
  EXPECT_EQ(heap.name(), std::string("/dev/dma_heap/vidbuf_cached"));
  EXPECT_EQ(kernel_.open_files(), 0u);
}

TEST_F(DmaBufferTest, PlanesOfOneFileShareOneMapping) {
  fake::DmaBufferFile memory(300);
  const int file = kernel_.adopt(memory);
  DmaMapping mapping;
  ASSERT_EQ(mapping.map({{DmaPlane{file, 0, 200}, DmaPlane{file, 200, 100}}}), 0);
  EXPECT_EQ(mapping.plane(1), mapping.plane(0) + 200);
  memory.write(200, {7});
  EXPECT_EQ(mapping.plane(1)[0], 0);  // still the content of the caches
  EXPECT_EQ(mapping.begin_read(), 0);
  EXPECT_EQ(mapping.plane(1)[0], 7);
  EXPECT_EQ(mapping.end_read(), 0);
  EXPECT_EQ(mapping.end_read(), 0);  // no read to end
  mapping.unmap();
  EXPECT_FALSE(memory.mapped());
  EXPECT_EQ(memory.violation(), "");
  ASSERT_NE(mapping.map({{DmaPlane{file, 0, 301}, DmaPlane{}}}), 0);
  EXPECT_EQ(mapping.plane(0), nullptr);
}

TEST_F(DmaBufferTest, PlanesOfTwoFilesAreBothSynchronized) {
  fake::DmaBufferFile luma(200), chroma(108);
  const int first = kernel_.adopt(luma), second = kernel_.adopt(chroma);
  {
    DmaMapping mapping;
    ASSERT_EQ(mapping.map({{DmaPlane{first, 0, 200}, DmaPlane{second, 8, 100}}}), 0);
    luma.write(0, {1});
    chroma.write(8, {2});
    kernel_.interrupt_requests(3);
    ASSERT_EQ(mapping.begin_read(), 0);
    EXPECT_EQ(mapping.plane(0)[0], 1);
    EXPECT_EQ(mapping.plane(1)[0], 2);
    chroma.fail_with = EIO;
    EXPECT_EQ(mapping.end_read(), EIO);
    EXPECT_FALSE(luma.reading());
    EXPECT_EQ(mapping.end_read(), 0);
    EXPECT_FALSE(chroma.reading());
  }
  EXPECT_FALSE(luma.mapped() || chroma.mapped());
  EXPECT_EQ(luma.violation() + chroma.violation(), "");
}

TEST_F(DmaBufferTest, OrdinaryMemoryIsNotSynchronized) {
  fake::DmaBufferFile memory(100);
  memory.is_dma = false;
  DmaMapping mapping;
  ASSERT_EQ(mapping.map({{DmaPlane{kernel_.adopt(memory), 0, 100}, DmaPlane{}}}), 0);
  memory.write(0, {9});
  EXPECT_EQ(mapping.begin_read(), 0);
  EXPECT_EQ(mapping.end_read(), 0);
  EXPECT_EQ(mapping.plane(0)[0], 9);
}

}  // namespace
}  // namespace touchline::hal
