// Writes a custom macro variable and reads it, the positions and a parameter of a FANUC control.
using System;
using System.Runtime.InteropServices;

public static class FanucMacro
{
    public static int Main()
    {
        ushort handle = 0;
        short code = Fwlib32.cnc_allclibhndl(ref handle);
        Console.WriteLine("open {0}", code);
        if (code != 0)
            return 1;
        Console.WriteLine("write {0}", Fwlib32.cnc_wrmacro(handle, 103, 10, 271828, 5));
        var macro = new Fwlib32.ODBM();
        code = Fwlib32.cnc_rdmacro(handle, 103, (short)Marshal.SizeOf(macro), ref macro);
        Console.WriteLine("macro {0}: {1} {2}", code, macro.mcr_val, macro.dec_val);
        var at = new Fwlib32.ODBAXIS();
        code = Fwlib32.cnc_absolute(handle, Fwlib32.ALL_AXES, 4 + 4 * 3, ref at);
        Console.WriteLine("position {0}: {1} {2} {3}", code, at.data[0], at.data[1], at.data[2]);
        Console.WriteLine("too short {0}", Fwlib32.cnc_absolute(handle, Fwlib32.ALL_AXES, 4 + 4 * 3 - 1, ref at));
        var parameter = new Fwlib32.IODBPSD();
        code = Fwlib32.cnc_rdparam(handle, 1420, 1, 8, ref parameter);
        Console.WriteLine("parameter {0}: {1}", code, BitConverter.ToInt32(parameter.u.bytes, 0));
        Console.WriteLine("free {0}", Fwlib32.cnc_freelibhndl(handle));
        return 0;
    }
}
