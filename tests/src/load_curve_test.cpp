#include "load_curve.h"
#include <gtest/gtest.h>
