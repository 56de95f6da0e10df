"""The control itself: a Power Mate on a control without a vendor."""
