"""Records of four floats, loaded whole."""

import warp as wp


@wp.func_native("""
#if defined(__CUDA_ARCH__)
    float4 q = __ldg(reinterpret_cast<const float4*>(records.data) + i);
    return wp::vec_t<4, float>(q.x, q.y, q.z, q.w);
#else
    return records.data[i];
#endif
""")
def load_record(records: wp.array(dtype=wp.vec4), i: int) -> wp.vec4:
    """One 16-byte load where Warp's own indexing makes four of 4 bytes.

    For arrays whose entry i nobody writes in the same kernel.
    """
