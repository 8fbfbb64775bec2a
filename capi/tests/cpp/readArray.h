// Arrays in the files that the tests and benchmarks hand to their programs: a count, then so many values.
#pragma once

#include <cstddef>
#include <istream>
#include <vector>

template <typename T>
std::vector<T>
ReadArray(std::istream &in) {
    size_t count = 0;
    in >> count;
    std::vector<T> values(count);
    for (T &value : values) {
        in >> value;
    }
    return values;
}
