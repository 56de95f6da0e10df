Attribute VB_Name = "apci_jog"
' Closes the loop of an axis of the APCI board, jogs it to 12.5 mm and waits until it is there.
Option Explicit

Public Sub Main()
    Dim axes(0 To 17) As TSRP
    Dim system_ As ROSI
    Dim chosen As AS_
    Dim kind As Long
    Dim code As Long
    Dim left_ As Long

    code = InitMcuSystem3(axes(0), system_, 0, "system.dat", kind)
    Debug.Print "init " & code & ", board " & kind & ", " & system_.number_axis & " axes"
    If code <> 0 Then
        Exit Sub
    End If
    chosen.unoa = 1
    chosen.san(0) = 0
    cl chosen
    axes(0).tp = 12.5
    ja chosen, axes(0)
    left_ = 2000000
    Do While rdaxstb(0, 13) = 0 And left_ > 0
        left_ = left_ - 1
    Loop
    rddp axes(0)
    Debug.Print "at " & Format(axes(0).dp, "0.000")
End Sub
