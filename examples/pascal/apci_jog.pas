{ Closes the loop of an axis of the APCI board, jogs it to 12.5 mm and waits until it is there. }
program apci_jog;

{$IFDEF FPC}{$MODE DELPHI}{$ENDIF}

uses
  mcug3;

var
  axes: array[0..MAXAXIS - 1] of TSRP;
  system_: ROSI;
  chosen: AS_;
  kind, code, left: LongInt;
begin
  FillChar(axes, SizeOf(axes), 0);
  FillChar(chosen, SizeOf(chosen), 0);
  kind := 0;
  code := InitMcuSystem3(axes[0], system_, 0, 'system.dat', kind);
  WriteLn('init ', code, ', board ', kind, ', ', system_.number_axis, ' axes');
  if code <> 0 then
    Halt(1);
  chosen.unoa := 1;
  chosen.san[0] := 0;
  cl(chosen);
  axes[0].tp := 12.5;
  ja(chosen, axes[0]);
  left := 2000000;
  while (rdaxstb(0, 13) = 0) and (left > 0) do
    Dec(left);
  rddp(axes[0]);
  WriteLn('at ', axes[0].dp:0:3);
end.
